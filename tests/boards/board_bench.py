"""A board's emitted top with the models of its vendor's cells, in a simulator."""

import pathlib

from hdl.boards.emit import board_verilog
from hdl.system.cpu import cpu_verilog
from tests.hdl import harness

__all__ = ["simulate_board"]

CELLS = pathlib.Path(__file__).parents[2] / "sim" / "boards"


def simulate_board(board, name, simulator, arrays, *, cells, size):
    """Run ``tests.boards.tb_NAME`` on the module NAME_bench of sim/boards, around a board called ``name``."""
    texts = [(CELLS / f"{cell}.v").read_text() for cell in (*cells, f"{name}_bench")]
    verilog = "\n".join([board_verilog(board, name), cpu_verilog(), *texts])
    return harness.simulate(f"{name}_bench", verilog, simulator, arrays, size=size, testbench=f"tests.boards.tb_{name}")
