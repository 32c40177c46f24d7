"""RasterPose on a ULX3S, an open board with an ECP5."""
