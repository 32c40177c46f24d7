"""Results of whole frames, where software finds them."""
