"""Verilog of a board's top: a module whose ports are the board's signals, by their names."""

from hdl.convert import convert

__all__ = ["board_verilog"]


def board_verilog(board, name):
    """Verilog of an elaboratable with ``ports``: name -> Signal or IOPort."""
    return convert(board, name, {port: (signal, None) for port, signal in board.ports.items()})
