"""A D5M from its pins to the stream: set up, then pictures bit for bit, whatever the two clocks; turned or not."""

import numpy as np
import pytest

from hdl.camera.d5m import D5m
from hdl.camera.d5m_table import D5M_EXPOSURE, D5M_GAIN, d5m_order, d5m_table
from sim.models.capture import capture
from sim.models.d5m import D5mCamera
from sim.models.demosaic import as_received, demosaic
from sim.models.framer import framer
from tests.hdl import harness
from tests.hdl.camera_bench import check_reset, check_set_up_again, colours, play
from tests.hdl.tb_camera import Op

COLUMNS, ROWS = 24, 6
CLOCK_HZ, TICK_US = 2_000_000, 100
SYNC_PS = 10**12 // CLOCK_HZ
#: PIXCLK of up to twice the system's clock brings at most one pixel a clock.
FAST_PS, SLOW_PS = 251_000, 1_733_000
EXPOSURE, GAIN = 300, 12
#: Clocks of the camera in which there is a reset, in the middle of a row.
CUT = (400, 12)


def pictures(count, seed):
    return list(np.random.default_rng(seed).integers(0, 256, (count, ROWS, COLUMNS, 3), dtype=np.uint8))


SEQUENCES = {"fast": (pictures(3, 1), FAST_PS), "slow": (pictures(1, 2), SLOW_PS)}


def broken():
    """FVAL and LVAL that also change where they should not."""
    rng = np.random.default_rng(4)
    pins = D5mCamera(blank=2).play(pictures(4, 3), is_set_up=True, order="GRBG")
    for name, count in (("lval", 12), ("fval", 3)):
        at = rng.integers(0, len(pins["lval"]), count)
        pins[name][at] ^= 1
    return pins


@pytest.fixture(scope="module", params=["verilator", "icarus"])
def run(request):
    """States after each step, writes, and payloads, of one simulation of everything."""
    if reason := harness.missing(request.param):
        pytest.skip(reason)
    videos = [
        D5mCamera().play(pictures(1, 0)),
        *(D5mCamera(blank=5).play(shown, is_set_up=True, order="GRBG") for shown, _ in SEQUENCES.values()),
        broken(),
        D5mCamera(blank=5).play(pictures(2, 5), is_set_up=True, order="GRBG"),
    ]
    program = [
        (Op.VALUES, EXPOSURE | GAIN << 16), (Op.RESET, 2), (Op.PLAY, 0, FAST_PS), (Op.FINISH, 0, 60_000),
        (Op.PLAY, 1, FAST_PS), (Op.PLAY, 2, SLOW_PS), (Op.PLAY, 3, FAST_PS),
        (Op.CUT, *CUT), (Op.PLAY, 4, FAST_PS), (Op.FINISH, 0, 60_000),
    ]  # fmt: skip
    component = D5m(width=COLUMNS, clock_hz=CLOCK_HZ, tick_us=TICK_US, depth=16)
    return *play(component, "d5m", request.param, program, table=d5m_table(), sync_ps=SYNC_PS, videos=videos), videos


def part(run, step):
    """Colours and marks of what came in a step."""
    states, _, beats, _ = run
    return colours(beats[states[step - 1].beats : states[step].beats])


def check_errors(sof, eol):
    framed = framer(sof, eol, COLUMNS, ROWS, width=COLUMNS, height=ROWS)
    return sum(len(found) for found in framed.errors.values())


def test_before_it_is_set_up(run):
    """There are pixels, but no picture of the right size."""
    _, sof, eol = part(run, 2)
    assert sof.sum() == 1 and not eol.any() and check_errors(sof, eol)  # Rows are too long.


def test_set_up(run):
    states, writes, *_ = run
    camera = D5mCamera()
    assert not camera.is_set_up and camera.size == (2592, 1944)
    camera.bus.writes.extend(writes)
    assert camera.is_set_up and camera.size == (1280, 960) and camera.pixel_clock_mhz == 50 and camera.order == "GRBG"
    assert (camera.registers[D5M_EXPOSURE], camera.registers[D5M_GAIN]) == (EXPOSURE, GAIN)
    assert states[3].done and not states[3].failed


@pytest.mark.parametrize("step, name", [(4, "fast"), (5, "slow")])
def test_pictures(run, step, name):
    seen, sof, eol = part(run, step)
    expected = np.stack([as_received(picture) for picture in SEQUENCES[name][0]])
    assert (seen == expected.reshape(-1, 3)).all() and (expected == SEQUENCES[name][0]).all()
    index = np.arange(len(seen))
    assert (sof == (index % (COLUMNS * ROWS) == 0)).all() and (eol == (index % COLUMNS == COLUMNS - 1)).all()
    assert not run[0][step].lost


def test_broken_video_goes_on_as_it_is(run):
    """Bit for bit the models', and the framer's model finds it broken."""
    seen, sof, eol = part(run, 6)
    expected, expected_sof, expected_eol = demosaic(*capture(**run[3][3]), width=COLUMNS)
    assert len(seen) == len(expected)
    known = expected[:, 0] >= 0
    assert (seen[known] == expected[known]).all() and known.mean() > 0.5
    assert (sof == expected_sof).all() and (eol == expected_eol).all()
    assert check_errors(sof, eol) >= 3


def test_reset_in_the_middle_of_a_picture(run):
    check_reset(part(run, 8), np.stack([as_received(picture) for picture in pictures(2, 5)]))
    check_set_up_again(run[0][9], run[1])


@pytest.mark.parametrize("is_turned", [False, True])
def test_the_order_is_the_cameras(is_turned):
    camera = D5mCamera()
    camera.bus.writes.extend(
        (0, *entry) for entry in d5m_table(is_turned=is_turned).entries if isinstance(entry, tuple)
    )
    assert camera.is_set_up and camera.order == d5m_order(is_turned=is_turned)


@pytest.mark.parametrize(
    "register, value", [(0x23, 0), (0x03, 1943), (0x02, 17), (0x0A, 0), (0xA0, 1), (0x12, 0), (0x0D, 1)]
)
def test_camera_itself(register, value):
    """One wrong register, and it does not show the picture."""
    camera = D5mCamera()
    camera.bus.writes.extend((0, *entry) for entry in d5m_table().entries if isinstance(entry, tuple))
    camera.bus.writes.append((0, register, value))
    assert not camera.is_set_up
