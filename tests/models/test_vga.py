"""The monitor's model: it shows what is right, and takes nothing else for it; and the modes that it is given."""

import numpy as np
import pytest

from hdl.display.timing import FULL_HD, VGA, VideoMode
from sim.models.vga import VgaMonitor, Violation

MODE = VideoMode(columns=20, column_front=2, column_sync=5, column_back=3, rows=10, row_front=1, row_sync=2, row_back=4,
                 v_positive=True)  # fmt: skip
WIDTH, HEIGHT = MODE.total_columns, MODE.total_rows


def cable(pictures, mode=MODE):
    """Levels of the lines, written down from the definition of a mode: three and a bit pictures, from anywhere on."""
    width, height = mode.total_columns, mode.total_rows
    at = np.arange(len(pictures) * width * height)
    column, row = at % width, at // width % height
    in_hsync = (column >= mode.columns + mode.column_front) & (column < width - mode.column_back)
    line = (at - mode.columns - mode.column_front) // width % height + 1
    in_vsync = (line >= mode.rows + mode.row_front) & (line < mode.rows + mode.row_front + mode.row_sync)
    active = (column < mode.columns) & (row < mode.rows)
    rgb = np.zeros((len(at), 3), np.uint8)
    rgb[active] = np.concatenate([picture.reshape(-1, 3) for picture in pictures])
    return {
        "hsync": in_hsync == mode.h_positive,
        "vsync": in_vsync == mode.v_positive,
        "rgb": rgb,
        "active": active,
    }


@pytest.fixture
def pictures():
    return np.random.default_rng(1).integers(0, 256, (4, MODE.rows, MODE.columns, 3), np.uint8)


@pytest.mark.parametrize("start", [0, 1, 77, WIDTH * MODE.rows])
def test_right(pictures, start):
    lines = {name: values[start:] for name, values in cable(pictures).items()}
    shown = VgaMonitor(MODE).pictures(**lines)
    assert len(shown) == 3 and all((one == other).all() for one, other in zip(shown, pictures[1:], strict=True))


@pytest.mark.parametrize("change", ["column_front", "column_sync", "column_back", "columns", "row_front", "row_sync",
                                    "row_back", "rows", "h_positive", "v_positive"])  # fmt: skip
def test_another_mode(pictures, change):
    values = {name: getattr(MODE, name) for name in MODE.__dataclass_fields__}
    values[change] = not values[change] if change.endswith("positive") else values[change] + 1
    with pytest.raises(Violation):
        VgaMonitor(VideoMode(**values)).pictures(**cable(pictures))


@pytest.mark.parametrize("name, at, phrase", [
    ("hsync", 3 * WIDTH + MODE.columns + MODE.column_front + MODE.column_sync, "hsync lasts for"),
    ("hsync", 3 * WIDTH + 4, "hsync has a period of"),
    ("vsync", 2 * WIDTH * HEIGHT, "vsync has a period of"),
    ("active", 2 * WIDTH * HEIGHT, "the blanking signal is wrong"),
    ("rgb", 2 * WIDTH * HEIGHT + MODE.columns, "there is colour while the beam is blanked"),
])  # fmt: skip
def test_one_sample_wrong(pictures, name, at, phrase):
    lines = cable(pictures)
    lines[name][at] = ~lines[name][at]
    with pytest.raises(Violation, match=phrase):
        VgaMonitor(MODE).pictures(**lines)


def test_nothing_whole(pictures):
    lines = {name: values[: 2 * WIDTH * HEIGHT - 5] for name, values in cable(pictures).items()}
    with pytest.raises(Violation, match=r"vsync has \d pulses|there is no whole picture"):
        VgaMonitor(MODE).pictures(**lines)


def test_modes():
    """Clocks a row and rows a picture, as VESA has them, and the pixel clocks that follow of 60 Hz."""
    assert (VGA.total_columns, VGA.total_rows) == (800, 525)
    assert (FULL_HD.total_columns, FULL_HD.total_rows) == (2200, 1125)
    assert 60 * 2200 * 1125 == 148_500_000
