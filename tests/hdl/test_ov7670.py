"""An OV7670 from its pins to the stream: set up, then pictures bit for bit, whatever the two clocks."""

import numpy as np
import pytest

from hdl.camera.ov7670 import Ov7670
from hdl.camera.ov7670_table import OV7670_TABLE
from sim.models.framer import framer
from sim.models.ov7670 import Ov7670Camera
from sim.models.rgb565 import as_received, rgb565
from tests.hdl import harness
from tests.hdl.camera_bench import check_reset, check_set_up_again, colours, play
from tests.hdl.tb_camera import Op

COLUMNS, ROWS = 40, 6
CLOCK_HZ, TICK_US = 2_000_000, 100
SYNC_PS = 10**12 // CLOCK_HZ
#: PCLK of up to twice the system's clock brings at most one pixel a clock.
FAST_PS, SLOW_PS = 251_000, 1_733_000
#: Clocks of the camera in which there is a reset, in the middle of a row.
CUT = (700, 12)


def pictures(count, seed):
    return list(np.random.default_rng(seed).integers(0, 256, (count, ROWS, COLUMNS, 3), dtype=np.uint8))


def broken(picture):
    """Rows that are a byte short, a byte and a pixel long, and without pixels; then VSYNC in the middle of a row."""
    camera = Ov7670Camera(blank=10)
    pins = camera.play([picture, picture], is_set_up=True)
    rises = np.flatnonzero(np.diff(pins["href"], prepend=0) == 1)
    pins["href"][rises[1]] = pins["href"][rises[2] - 1] = 0
    pins["href"][rises[2] - 1] = 1
    pins["href"][rises[4] - 2 : rises[4]] = 1
    pins["href"][rises[5] + 1 : rises[5] + 2 * COLUMNS] = 0
    pins["vsync"][rises[8] + 20 : rises[8] + 23] = 1
    return pins


SEQUENCES = {
    "fast": (pictures(3, 1), FAST_PS),
    "slow": (pictures(1, 2), SLOW_PS),
}  # fmt: skip


@pytest.fixture(scope="module", params=["verilator", "icarus"])
def run(request):
    """States after each step, writes, and payloads, of one simulation of everything."""
    if reason := harness.missing(request.param):
        pytest.skip(reason)
    camera = Ov7670Camera(blank=10)
    videos = [
        camera.play(pictures(1, 0)),
        *(camera.play(shown, is_set_up=True) for shown, _ in SEQUENCES.values()),
        broken(pictures(1, 3)[0]),
        camera.play(pictures(2, 5), is_set_up=True),
    ]
    program = [
        (Op.RESET, 2), (Op.PLAY, 0, FAST_PS), (Op.FINISH, 0, 60_000),
        (Op.PLAY, 1, FAST_PS), (Op.PLAY, 2, SLOW_PS), (Op.PLAY, 3, FAST_PS),
        (Op.CUT, *CUT), (Op.PLAY, 4, FAST_PS), (Op.FINISH, 0, 60_000),
    ]  # fmt: skip
    component = Ov7670(clock_hz=CLOCK_HZ, tick_us=TICK_US, depth=16)
    states, writes, beats = play(
        component, "ov7670", request.param, program, table=OV7670_TABLE, sync_ps=SYNC_PS, videos=videos
    )
    return states, writes, beats, videos


def part(run, step):
    """Colours and marks of what came in a step."""
    states, _, beats, _ = run
    return colours(beats[states[step - 1].beats : states[step].beats])


def test_before_it_is_set_up(run):
    """There are pixels, but no picture of the right size."""
    _, sof, eol = part(run, 1)
    assert sof.sum() == 1 and eol.sum() == ROWS
    assert framer(sof, eol, COLUMNS, ROWS, width=COLUMNS, height=ROWS).errors["short_line"].size


def test_set_up(run):
    states, writes, *_ = run
    camera = Ov7670Camera()
    assert not camera.is_set_up
    camera.bus.writes.extend(writes[: states[2].writes])
    assert camera.is_set_up and states[2].done and not states[2].failed
    assert [write[1:] for write in writes[: states[2].writes]] == [
        entry for entry in OV7670_TABLE.entries if isinstance(entry, tuple)
    ]
    camera.bus.writes.append((0, 0x12, 0x80))
    assert not camera.is_set_up


@pytest.mark.parametrize("step, name", [(3, "fast"), (4, "slow")])
def test_pictures(run, step, name):
    seen, sof, eol = part(run, step)
    expected = np.stack([as_received(picture) for picture in SEQUENCES[name][0]])
    assert (seen == expected.reshape(-1, 3)).all()
    index = np.arange(len(seen))
    assert (sof == (index % (COLUMNS * ROWS) == 0)).all() and (eol == (index % COLUMNS == COLUMNS - 1)).all()
    assert not run[0][step].lost


def test_broken_video_goes_on_as_it_is(run):
    """Bit for bit the model's, which the framer's model calls broken."""
    seen, sof, eol = part(run, 5)
    expected, expected_sof, expected_eol = rgb565(**run[3][3])
    assert (seen == expected).all() and (sof == expected_sof).all() and (eol == expected_eol).all()
    framed = framer(sof, eol, COLUMNS, ROWS, width=COLUMNS, height=ROWS)
    assert sum(len(found) for found in framed.errors.values()) >= 2 and not framed.last.any()


def test_reset_in_the_middle_of_a_picture(run):
    check_reset(part(run, 7), np.stack([as_received(picture) for picture in pictures(2, 5)]))
    check_set_up_again(run[0][8], run[1])


def test_colours_keep_full_scale():
    grey = np.repeat(np.arange(256, dtype=np.uint8).reshape(16, 16, 1), 3, axis=2)
    seen = as_received(grey).astype(int)
    assert (seen[0, 0] == 0).all() and (seen[-1, -1] == 255).all()
    assert abs(seen - grey).max() <= 7 and (np.diff(seen.reshape(-1, 3), axis=0) >= 0).all()
