"""The processor, its memory and its way to the registers."""
