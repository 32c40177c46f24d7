"""Behavioural models, in Verilog, of the vendors' cells that boards use."""
