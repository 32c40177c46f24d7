"""The display with its stores, and a monitor: what it shows is, to the pixel, what was published."""

import itertools

import numpy as np
import pytest

from hdl.config import SensorConfig
from hdl.display.display import Display
from hdl.display.marks import Code
from hdl.display.timing import VideoMode
from hdl.emit import to_verilog
from sim.models.painter import codes, paint, picture
from sim.models.vga import VgaMonitor
from tests.hdl.display_bench import CONFIG, MODE, DisplayBench, beats, lists
from tests.hdl.harness import simulate
from tests.hdl.tb_display import Op

PICTURE = MODE.total_columns * MODE.total_rows
ROW = MODE.total_columns
EMPTY = {"boxes": np.zeros((0, 4), int), "corners": np.zeros((0, 2), int), "markers": np.zeros((0, 4, 2), int)}


def play(simulator, program, contents=(), *, period=7_000, pixel_period=12_700):
    """(pictures, log) of a program; ``contents`` are what ``Op.LOAD`` counts from 1 on."""
    arrays = {"program": program, "period": period, "pixel_period": pixel_period}
    for number, content in enumerate(contents, 1):
        which, kind, item = zip(*beats(content), strict=True)
        arrays |= {f"list.{number}": which, f"kind.{number}": kind, f"item.{number}": [f"{bits:x}" for bits in item]}
    captured = simulate(
        "display_bench",
        to_verilog(DisplayBench(), "display_bench"),
        simulator,
        arrays,
        size=f"{CONFIG.width}x{CONFIG.height}",
        testbench="tests.hdl.tb_display",
    )
    seen = captured["seen"]
    rgb = np.stack([seen >> shift & 255 for shift in (16, 8, 0)], axis=1)
    return VgaMonitor(MODE).pictures(seen >> 25 & 1, seen >> 26, rgb, active=seen >> 24 & 1), captured["log"].tolist()


def expected(content):
    return paint(CONFIG.width, CONFIG.height, MODE.columns, MODE.rows, **content)


def edge_cases():
    """Each item at its limits: one pixel, the whole frame, the border, one place for all."""
    right, bottom = CONFIG.width - 1, CONFIG.height - 1
    return {
        "boxes": [(0, 0, right, bottom), (0, 0, 0, 0), (right, bottom, right, bottom), (5, 5, 5, 40), (5, 5, 50, 5),
                  (5, 5, 60, 5), (5, 5, 9, 5), (7, 9, 8, 10)],
        "corners": [(3, 3), (4, 3), (6, 3), (60, 3), (3, 4), (10, 5), (10, 6), (10, 7), (60, 44)],
        "markers": [[(0, 0), (right, 0), (right, bottom), (0, bottom)], [(20, 20)] * 4,
                    [(right, 0), (0, bottom), (1, bottom), (right, 1)], [(30, 10), (40, 10), (41, 10), (44, 10)],
                    [(12, 30), (12, 31), (11, 31), (11, 30)], [(50, 5), (51, 40), (50, 41), (49, 20)]],
    }  # fmt: skip


def test_pictures(large_simulator):
    """Pictures one after the other, each published while the one before it is in its blank rows."""
    random = np.random.default_rng(3)
    few = [lists(random, *counts) for counts in ((3, 9, 1), (12, 30, 3), (2, 0, 0), (0, 64, 0), (0, 0, 8))]
    contents = [edge_cases(), *few, EMPTY, few[1]]
    program = [(Op.SHOW, (MODE.rows + MODE.row_front) * ROW)]
    for number in range(1, len(contents) + 1):
        program += [(Op.LOAD, number), (Op.BUSY, 0 if number < 3 else 60), (Op.SHOW, PICTURE)]
    program += [(Op.LATE, 0)]
    shown, log = play(large_simulator, program, contents)
    assert len(shown) == len(contents) - 1 and log == [0]
    for number, (got, content) in enumerate(zip(shown, contents, strict=False)):
        assert (got == expected(content)).all(), (
            f"picture {number}: {np.argwhere((got != expected(content)).any(2))[:5]}"
        )
    assert len(np.unique(codes(CONFIG.width, CONFIG.height, **edge_cases()))) == len(Code)


def row_is_of(row, y, contents):
    """A row of a picture is what some combination of lists of these contents gives."""
    for chosen in itertools.product(contents, repeat=3):
        content = {name: one[name] for name, one in zip(("boxes", "corners", "markers"), chosen, strict=True)}
        if (row == expected(content)[y]).all():
            return True
    return False


def test_exchange_in_the_middle(large_simulator):
    """Old lists above, new ones below; only in a row that was being painted there may be some of both."""
    random = np.random.default_rng(5)
    contents = [lists(random, 4, 20, 1), lists(random, 6, 40, 2)]
    program = [(Op.LOAD, 1), (Op.SHOW, PICTURE)]
    for number, rows in ((2, 31), (1, 26), (2, 20), (1, 43)):
        program += [(Op.SHOW, rows * ROW + 100), (Op.LOAD, number), (Op.SHOW, PICTURE - rows * ROW - 100)]
    shown, _ = play(large_simulator, program, contents)
    mixed = changes = 0
    for got in shown:
        for y in range(CONFIG.height):
            mixed += not row_is_of(got[y], y, contents)
        changes += any((got == expected(content)).all() for content in contents) is False
    assert changes >= 3 and mixed <= 2 * changes


def test_nothing_that_was_not_published(large_simulator):
    """Lists change all the time, to fewer and to more items, and the bus is busy: still only what was published."""
    random = np.random.default_rng(7)
    frames = [lists(random, 2, 5, 1), EMPTY, lists(random, 5, 15, 2)]
    merged = {name: np.concatenate([one[name] for one in frames]) for name in EMPTY}
    program = [(Op.BUSY, 100), (Op.SHOW, ROW)]
    program += [step for _ in range(110) for number in (1, 2, 3) for step in ((Op.LOAD, number), (Op.SHOW, ROW // 2))]
    shown, _ = play(large_simulator, [*program, (Op.SHOW, 2 * PICTURE)], frames)
    all_codes = codes(CONFIG.width, CONFIG.height, **merged)
    ground = picture(np.zeros_like(all_codes), MODE.columns, MODE.rows)
    somewhere = np.zeros(ground.shape[:2], bool)
    somewhere[: CONFIG.height, : CONFIG.width] = all_codes > 0
    for got in shown:
        assert (got == ground)[~somewhere].all()
    assert any((got != ground)[somewhere].any() for got in shown[:-1])
    assert (shown[-1] == expected(frames[-1])).all()


def test_reset_in_the_middle(large_simulator):
    """Of the painter: what was painted, and what was published, is gone; the monitor notices nothing else."""
    content = lists(np.random.default_rng(9), 8, 30, 2)
    program = [(Op.LOAD, 1), (Op.SHOW, PICTURE + 20 * ROW + 33), (Op.RESET, 3), (Op.SHOW, 2 * PICTURE), (Op.LOAD, 1)]
    shown, _ = play(large_simulator, [*program, (Op.SHOW, 2 * PICTURE)], [content])
    first, *_, last = shown
    before, after = expected(content), expected(EMPTY)
    assert (first[:20] == before[:20]).all() and (first[24:] == after[24:]).all()
    assert any((got == after).all() for got in shown) and (last == before).all()


def test_too_much_for_a_row(large_simulator):
    """The bus takes most clocks: rows are late and counted, markers come first, and the screen stays in step."""
    content = lists(np.random.default_rng(11), 32, 64, 3)
    program = [(Op.LOAD, 1), (Op.BUSY, 245), (Op.SHOW, 2 * PICTURE), (Op.LATE, 0), (Op.BUSY, 0)]
    shown, (late, later) = play(large_simulator, [*program, (Op.SHOW, 2 * PICTURE), (Op.LATE, 0)], [content])
    assert 10 < late <= 2 * CONFIG.height and later - late < 3
    partial, whole = shown[0], shown[-1]
    full = expected(content)
    assert (whole == full).all()
    same, code = (partial == full).all(2), np.zeros(full.shape[:2], int)
    code[: CONFIG.height, : CONFIG.width] = codes(CONFIG.width, CONFIG.height, **content)
    is_marker = (code == Code.OUTLINE.value) | (code >= Code.V1.value)
    assert same[is_marker].all() and not same.all()


@pytest.mark.parametrize("width, height", [(72, 48), (64, 52)])
def test_constructor(width, height):
    with pytest.raises(ValueError, match=f"must be at most 70 x 50, not {width} x {height}"):
        Display(config=SensorConfig(width=width, height=height), mode=MODE)


@pytest.mark.parametrize("value", [0, -1, 1.5])
def test_mode(value):
    numbers = {"columns": 8, "column_front": 1, "column_sync": 1, "column_back": 1, "rows": 8, "row_front": value}
    with pytest.raises(ValueError, match=f"row_front must be an integer from 1 up, not {value}"):
        VideoMode(**numbers, row_sync=1, row_back=1)
