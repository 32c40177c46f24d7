"""A board's emitted top with the models of its vendor's cells, in a simulator, and what it told."""

import functools
import pathlib

import numpy as np

from firmware.reference.sentence import parse
from hdl.boards.de2_115.top import De2115
from hdl.boards.emit import board_verilog
from hdl.boards.ulx3s.top import Ulx3s
from hdl.config import SensorConfig
from hdl.system.cpu import cpu_verilog
from sim.models.painter import paint
from sim.models.sensor import ModelSensor
from sim.results import Settings
from tests.hdl import harness
from tests.system.firmware_bench import found, frame_lines
from tests.system.serial_line import levels, received

__all__ = ["CELLS", "check_frame", "decimal", "emitted", "expected_screen", "models", "simulate_board", "told_lines"]

#: Vendors' cells that each board has.
CELLS = {"de2_115": ("altpll",), "ulx3s": ("ehxplll", "oddrx1f")}
_FOLDER = pathlib.Path(__file__).parents[2] / "sim" / "boards"


@functools.cache
def emitted(name):
    """Verilog of a board for small frames."""
    kind = {"de2_115": De2115, "ulx3s": Ulx3s}[name]
    return board_verilog(kind(config=SensorConfig(width=64, height=48)), name)


def models(*names):
    """File name -> Verilog of what is in sim/boards."""
    return {f"{name}.v": (_FOLDER / f"{name}.v").read_text() for name in names}


def simulate_board(board, name, simulator, arrays, *, size):
    """Run ``tests.boards.tb_NAME`` on the module NAME_bench of sim/boards, around a board called ``name``."""
    texts = models(*CELLS[name], f"{name}_bench").values()
    verilog = "\n".join([board_verilog(board, name), cpu_verilog(), *texts])
    return harness.simulate(f"{name}_bench", verilog, simulator, arrays, size=size, testbench=f"tests.boards.tb_{name}")


def decimal(segments, places):
    """The number that digits show; places from the lowest."""
    shapes = {0x3F: 0, 0x06: 1, 0x5B: 2, 0x4F: 3, 0x66: 4, 0x6D: 5, 0x7D: 6, 0x07: 7, 0x7F: 8, 0x6F: 9}
    return sum(shapes[~(segments >> 7 * place) & 0x7F] * 10**power for power, place in enumerate(places))


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
