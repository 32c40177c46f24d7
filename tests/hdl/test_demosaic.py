"""Bayer samples to pixels, in every order, whole and broken, with and without blanking."""

import numpy as np
import pytest

from hdl.camera.capture import BayerSample
from hdl.camera.demosaic import ORDERS, Demosaic, mirrored
from sim.engine import StreamEngine, pack
from sim.models.demosaic import as_received, demosaic, mosaic
from tests.hdl.camera_bench import colours

WIDTH, HEIGHT = 9, 4


def samples(rows, rng, *, start=True):
    """(level, sof, eol) of rows of these lengths, with levels at random."""
    level = rng.integers(0, 4096, sum(rows))
    sof, eol = np.zeros(len(level), bool), np.zeros(len(level), bool)
    sof[0] = start
    eol[np.cumsum(rows) - 1] = True
    return level, sof, eol


def run(engine, level, sof, eol, **options):
    beats = pack(BayerSample, level=level, sof=sof, eol=eol)
    return engine.run({"i": (beats, options.pop("idle", None))}, **options)["o"]


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(Demosaic(width=WIDTH))


def check(captured, expected):
    """Bit for bit where the model knows the colours, marks everywhere."""
    (seen, sof, eol), (wanted, wanted_sof, wanted_eol) = colours(captured.payload), expected
    assert len(seen) == len(wanted)
    known = wanted[:, 0] >= 0
    assert (seen[known] == wanted[known]).all() and known.any()
    assert (sof == wanted_sof).all() and (eol == wanted_eol).all()


@pytest.mark.parametrize("seed", range(3))
def test_random_rows(engine, seed):
    """Rows of every length, frames of every number of rows, starts in the middle; idle clocks and none."""
    rng = np.random.default_rng(seed)
    parts = []
    for _ in range(400):
        rows = np.full(rng.integers(1, 2 * HEIGHT + 3), rng.integers(1, 2 * WIDTH + 5))
        is_broken = rng.random(len(rows)) < 0.15
        rows[is_broken] = rng.integers(1, 2 * WIDTH + 5, is_broken.sum())
        level, sof, eol = samples(rows, rng)
        cut = len(level) if rng.random() < 0.7 else rng.integers(1, len(level) + 1)
        parts.append((level[:cut], sof[:cut], eol[:cut]))
    stream = tuple(np.concatenate(column) for column in zip(*parts, strict=True))
    idle = None if seed == 0 else rng.integers(0, 3, len(stream[0]))
    expected = demosaic(*stream, width=WIDTH)
    assert expected[2].sum() > 200 and (~expected[2] & expected[1]).any()
    check(run(engine, *stream, idle=idle), expected)


@pytest.mark.parametrize("order", ORDERS)
def test_orders(order):
    """A picture comes back, by the definition of the orders and not only by the model of the block."""
    picture = np.random.default_rng(1).integers(0, 256, (2, HEIGHT, WIDTH, 3), dtype=np.uint8)
    level = np.concatenate([mosaic(frame, order).ravel() for frame in picture])
    index = np.arange(len(level))
    sof, eol = index % (4 * WIDTH * HEIGHT) == 0, index % (2 * WIDTH) == 2 * WIDTH - 1
    seen, *_ = colours(run(StreamEngine(Demosaic(width=WIDTH, order=order)), level, sof, eol).payload)
    expected = np.concatenate([as_received(frame, order).reshape(-1, 3) for frame in picture])
    assert (seen == expected).all() and (seen == picture.reshape(-1, 3)).all()
    for place, colour in enumerate(order):
        row, column = divmod(place, 2)
        of_colour = level.reshape(2, 2 * HEIGHT, 2 * WIDTH)[:, row::2, column::2].ravel() >> 4
        assert (of_colour == picture.reshape(-1, 3)[:, "RGB".index(colour)]).all()


def test_mean_of_the_greens():
    """Cut to 10 bits, then to 8."""
    level = np.array([0xFFF, 0, 0, 0xFF8])  # G R, B G
    pixel, *_ = demosaic(level, [1, 0, 0, 0], [0, 1, 0, 1], width=2)
    assert pixel.tolist() == [[0, (0x3FF + 0x3FE) >> 3, 0]]


def test_mirrored():
    for order in ORDERS:
        block = np.array(list(order)).reshape(2, 2)
        assert mirrored(order, columns=True, rows=False) == "".join(block[:, ::-1].ravel())
        assert mirrored(order, columns=False, rows=True) == "".join(block[::-1].ravel())
        assert mirrored(order, columns=True, rows=True) == "".join(block[::-1, ::-1].ravel())


def test_reset_in_the_middle(engine):
    """What follows the next start is as after power-up."""
    rng = np.random.default_rng(5)
    first, second = samples([2 * WIDTH] * 3, rng), samples([2 * WIDTH] * 4, rng)
    stream = tuple(np.concatenate(pair) for pair in zip(first, second, strict=True))
    captured = run(engine, *stream, reset_at=(len(first[0]) - 5,))
    expected = demosaic(*second, width=WIDTH)
    seen, sof, eol = colours(captured.payload)
    count = len(expected[0])
    assert (seen[-count:] == expected[0]).all() and (sof[-count:] == expected[1]).all() and eol[-count:].sum() == 2


@pytest.mark.parametrize(
    "arguments, phrase",
    [
        ({"width": 1}, "width must be an integer from 2 up, not 1"),
        ({"order": "RGBG"}, "order must be one of GRBG, RGGB, BGGR, GBRG, not 'RGBG'"),
    ],
)
def test_constructor(arguments, phrase):
    with pytest.raises(ValueError, match=phrase):
        Demosaic(**arguments)
