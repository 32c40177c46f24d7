"""The TMDS encoder against the standard's flow chart, and back again; all three channels with a monitor at the end."""

import numpy as np
import pytest
from amaranth import Module
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.display.dvi import CLOCK_WORD, Dvi
from hdl.display.tmds import LATENCY
from hdl.pixels import unstalled
from sim.engine import StreamEngine, fields, pack
from sim.models.dvi import DviMonitor, TmdsEncoder, decode
from tests.hdl.harness import assert_same, cocotb_run

PIXEL = data.StructLayout({"b": 8, "g": 8, "r": 8, "active": 1, "hsync": 1, "vsync": 1})
WORDS = data.StructLayout({"words": data.ArrayLayout(10, 4)})


class DviBench(wiring.Component):
    """A pixel in, words out, in every clock."""

    def __init__(self, width=0, height=0):
        super().__init__({"i": In(unstalled(PIXEL)), "o": Out(unstalled(WORDS))})

    def elaborate(self, platform):
        m = Module()
        m.submodules.dvi = dvi = Dvi()
        m.d.comb += [
            *(getattr(dvi.i, name).eq(self.i.payload[name]) for name in PIXEL.members),
            self.o.payload.words.eq(dvi.o),
            self.o.valid.eq(1),
        ]
        return m


def pixels(count, seed):
    """Random rows of random length, some of few colours; then every byte twice."""
    random = np.random.default_rng(seed)
    active = np.repeat(np.arange(count) % 2, random.integers(1, 40, count))[:count]
    colour = random.integers(0, 256, (3, count))
    colour[:, : count // 3] = random.choice([0, 1, 16, 127, 128, 255], (3, count // 3))
    tail = np.repeat(np.arange(256), 2)
    b, g, r = (np.concatenate([channel, tail]) for channel in colour)
    hsync, vsync = random.integers(0, 2, (2, count + len(tail)))
    return {
        "b": b,
        "g": g,
        "r": r,
        "hsync": hsync,
        "vsync": vsync,
        "active": np.append(active, np.ones(len(tail), int)),
    }


def expected(given):
    """Words of blue, green, red."""
    channels = []
    for name in "bgr":
        encoder = TmdsEncoder()
        control = given["hsync"] + 2 * given["vsync"] if name == "b" else np.zeros_like(given["b"])
        rows = zip(given[name].tolist(), control.tolist(), given["active"].tolist(), strict=True)
        channels.append([encoder.encode(*row) for row in rows])
    return np.array(channels).T


def check(run, given, start=0):
    words = fields(run["o"], WORDS)["words"][LATENCY:]
    assert (words[start : len(given["b"]), :3] == expected(given)[start:]).all()
    assert (words[:, 3] == CLOCK_WORD).all()


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(DviBench)


def test_words(engine):
    given = pixels(60_000, seed=1)
    engine.reset()
    check(engine.run({"i": pack(PIXEL, **given)}), given)


def test_emitted_verilog(simulator):
    """With a blanking in the middle, in which the sums begin anew."""
    given = pixels(1200, seed=2)
    given["active"][595:602] = 0
    stimulus = {"i": pack(PIXEL, **given)}
    run = cocotb_run(DviBench(), simulator, stimulus)
    check(run, given)
    assert_same(run, StreamEngine(DviBench).run(stimulus))


def test_reset_in_the_middle(engine, simulator):
    """Of a row: what is on its way is lost, and the sums begin anew."""
    given, cut = pixels(900, seed=6), 333
    given["active"][cut - 20 : cut + 20] = 1
    stimulus = {"i": pack(PIXEL, **given)}
    run = cocotb_run(DviBench(), simulator, stimulus, reset_at=[cut])
    words = fields(run["o"], WORDS)["words"][:, :3]
    parts = [{name: values[part] for name, values in given.items()} for part in (slice(cut), slice(cut, None))]
    before, after = (expected(part) for part in parts)
    assert (words[LATENCY:cut] == before[: cut - LATENCY]).all()
    assert (words[cut + LATENCY : len(given["b"]) + LATENCY] == after).all()
    assert (after[:20] != expected(given)[cut : cut + 20]).any()
    engine.reset()
    assert_same(run, engine.run(stimulus, reset_at=[cut]))


def test_what_is_sent_is_what_is_received():
    given = pixels(5_000, seed=3)
    words = expected(given)
    for number, name in enumerate("bgr"):
        value, control, active = decode(words[:, number])
        assert (active == (given["active"] == 1)).all()
        assert (value[active] == given[name][active]).all()
        assert name != "b" or (control == given["hsync"] + 2 * given["vsync"])[~active].all()


def bits(words, start):
    return (words[:, None] >> np.arange(10) & 1).reshape(-1)[start:]


def test_monitor():
    given = pixels(5_000, seed=4)
    words = expected(given)
    clock = bits(np.full(len(words), CLOCK_WORD), 7)
    channels = [bits(words[:, number], 7) for number in range(3)]
    hsync, _, rgb, active = DviMonitor().receive(*channels, clock)
    shown = slice(1, 1 + len(active))
    assert (active == given["active"][shown]).all() and len(active) > 5_000
    assert (rgb[active] == np.stack([given[name] for name in "rgb"], axis=1)[shown][active]).all()
    assert (hsync == given["hsync"][shown])[~active].all()
    with pytest.raises(ValueError, match="the channels are not in step"):
        DviMonitor().receive(channels[0], np.roll(channels[1], 1), channels[2], clock)
    with pytest.raises(ValueError, match="the clock does not have the period of a word"):
        DviMonitor().receive(*channels, np.roll(bits(np.full(len(words), 0b0001100011), 7), 1))
    with pytest.raises(ValueError, match="channel b has no blanking"):
        DviMonitor().receive(np.zeros(10_000, int), *channels[1:], clock)
