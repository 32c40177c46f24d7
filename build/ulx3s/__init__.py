"""A bitstream for the ULX3S by open tools: ``python -m build.ulx3s``."""
