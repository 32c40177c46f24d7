"""The commands of ``python -m sim``, one a file; ``app`` gathers them."""
