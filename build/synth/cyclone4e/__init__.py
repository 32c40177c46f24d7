"""How Yosys is made to map for Cyclone IV: cells, memory block, carry chains, and the order of its passes."""
