"""What the processor needs for a pose, a function and an operation, measured on the system's Verilog."""
