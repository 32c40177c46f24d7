"""The published results as a picture on a monitor, without a frame buffer."""
