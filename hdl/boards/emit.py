"""Verilog of a board's top: a module whose ports are the board's signals, by their names."""

import os

from amaranth.back import verilog

__all__ = ["board_verilog"]


def board_verilog(board, name):
    """Verilog of an elaboratable with ``ports``: name -> Signal or IOPort."""
    os.environ["AMARANTH_USE_YOSYS"] = "builtin"
    ports = {port: (signal, None) for port, signal in board.ports.items()}
    return verilog.convert(board, name, ports=ports, emit_src=False, strip_internal_attrs=True)
