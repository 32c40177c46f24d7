"""A board's emitted top with the models of its vendor's cells, in a simulator, and what it told."""

import pathlib

import numpy as np

from firmware.reference.sentence import parse
from hdl.boards.emit import board_verilog
from hdl.system.cpu import cpu_verilog
from sim.models.painter import paint
from sim.models.sensor import ModelSensor
from sim.results import Settings
from tests.hdl import harness
from tests.system.firmware_bench import found, frame_lines
from tests.system.serial_line import levels, received

__all__ = ["check_frame", "expected_screen", "simulate_board", "told_lines"]

CELLS = pathlib.Path(__file__).parents[2] / "sim" / "boards"


def simulate_board(board, name, simulator, arrays, *, cells, size):
    """Run ``tests.boards.tb_NAME`` on the module NAME_bench of sim/boards, around a board called ``name``."""
    texts = [(CELLS / f"{cell}.v").read_text() for cell in (*cells, f"{name}_bench")]
    verilog = "\n".join([board_verilog(board, name), cpu_verilog(), *texts])
    return harness.simulate(f"{name}_bench", verilog, simulator, arrays, size=size, testbench=f"tests.boards.tb_{name}")


def expected_screen(picture, mode, settings=Settings()):  # noqa: B008 - frozen
    """What the display makes of what the model finds in a grey or coloured picture."""
    rows, columns = picture.shape[:2]
    (result,) = ModelSensor(columns, rows).run([picture], settings)
    corners = np.stack([result.corners["x"], result.corners["y"]], axis=1)
    lists = {"boxes": result.blobs["box"], "corners": corners, "markers": result.markers["vertices"]}
    return paint(columns, rows, mode.columns, mode.rows, **lists)


def told_lines(captured, period_ns, divisor):
    """Lines that went over the serial line, without the status that the program begins with."""
    text = received(levels(captured["line"], period_ns, captured["end"]), divisor).decode("ascii")
    status, *rest, end = text.split("\r\n")
    assert parse(status).name == "RPSTA" and end == ""
    return rest


def check_frame(told, number, picture, *, camera, clock_hz, settings=Settings()):  # noqa: B008 - frozen
    """Sentences of a frame, equal to the reference's of what the model finds; only the time is taken from them.

    Returns that time in clocks.
    """
    clocks = -(-int(parse(told[0]).fields[1].replace(".", "")) * clock_hz // 1_000_000)
    assert told == frame_lines(number, clocks, found(picture, settings), 0, camera=camera, clock_hz=clock_hz)
    return clocks
