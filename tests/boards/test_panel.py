"""The DE2-115's panel alone: what switches and keys become, and what registers look like in lights and digits."""

import numpy as np
import pytest
from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.boards.de2_115.panel import Panel
from hdl.config import SensorConfig
from hdl.regs.map import system_maps
from hdl.system.addresses import REGISTERS
from tests.boards.board_bench import decimal
from tests.hdl.peripheral_bench import Program, Run
from tests.hdl.simulators import missing

CONFIG = SensorConfig(width=64, height=48)
SECOND, BOUNCE = 9000, 6
AUTOMATIC = 1 << system_maps(CONFIG)["sensor"][1].register("threshold").field("automatic").low
#: Clocks in which every register was read and shown.
ROUND = 9000
REGISTERS_SHOWN = ("frame", "markers", "short_lines", "long_lines", "short_frames", "midline_starts")
INPUTS = ("camera_done", "camera_failed", "lost", "late", "irq", "pixel_clock")


def address(name):
    offset, registers = system_maps(CONFIG)["sensor"]
    return REGISTERS + offset + registers.register(name).offset


class _Bench(wiring.Component):
    """The panel, and registers of which one is set in each clock; what is written can be seen."""

    def __init__(self):
        super().__init__(
            {name: In(1) for name in INPUTS}
            | {"which": In(range(len(REGISTERS_SHOWN))), "value": In(16)}
            | {"key": In(1), "switches": In(18), "restart": Out(1), "exposure": Out(16), "gain": Out(16)}
            | {"taken": Out(18), "lights": Out(9), "digits": Out(56), "threshold": Out(32), "control": Out(32)}
            | {"writes": Out(8)}
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.panel = panel = Panel(config=CONFIG, second_clocks=SECOND, bounce_clocks=BOUNCE)
        host, is_second = panel.host, Signal()
        m.d.sync += is_second.eq(host.valid & ~host.ack)
        m.d.comb += [
            host.ack.eq(host.valid & is_second),
            *(getattr(panel, name).eq(getattr(self, name)) for name in (*INPUTS, "key", "switches")),
            self.restart.eq(panel.restart),
            self.exposure.eq(panel.camera_values[0]),
            self.gain.eq(panel.camera_values[1]),
            self.taken.eq(panel.switches_taken),
            self.lights.eq(panel.lights),
            self.digits.eq(panel.digits),
        ]
        registers = {name: Signal(32, name=name) for name in REGISTERS_SHOWN}
        for number, register in enumerate(registers.values()):
            with m.If(self.which == number):
                m.d.sync += register.eq(self.value)
        with m.Switch(host.address):
            for name, register in registers.items():
                with m.Case(address(name) >> 2):
                    m.d.comb += host.read_data.eq(register)
            for name in ("threshold", "control"):
                with m.Case(address(name) >> 2), m.If(host.ack & host.write):
                    m.d.sync += [getattr(self, name).eq(host.write_data), self.writes.eq(self.writes + 1)]
        return m


#: What is on for a phase of ROUND clocks each; what is not named is 0.
PHASES = [
    {"switches": 0, "markers": 3, "short_lines": 1},
    {"switches": 0x3FFFF, "camera_failed": 1, "markers": 64, "short_lines": 1, "long_lines": 20, "short_frames": 300,
     "midline_starts": 4000},
    {"switches": 70 | 60 << 9 | 1 << 16, "camera_done": 1, "irq": 1, "markers": 255, "short_lines": 9000,
     "midline_starts": 1000},
    {"switches": 200 | 1 << 8 | 5 << 9 | 2 << 16, "camera_done": 1},
]  # fmt: skip


@pytest.fixture(scope="module")
def given():
    """The phases; bounces in front of each; keys, a strobe and a clock in some, and frames that are counted."""
    clocks = ROUND * len(PHASES)
    values = {name: np.zeros(clocks, np.int64) for name in (*INPUTS, *REGISTERS_SHOWN, "key", "switches")}
    random = np.random.default_rng(2)
    for number, phase in enumerate(PHASES):
        for name, value in phase.items():
            values[name][number * ROUND : (number + 1) * ROUND] = value
        bounces = slice(number * ROUND, number * ROUND + 100)
        values["switches"][bounces] ^= np.where(random.random(100) < 0.4, random.integers(0, 1 << 18, 100), 0)
    values["key"][5000:5020] = values["key"][15000:15003] = values["key"][20000:29000] = 1
    values["key"][20050:20053] = 0  # Shorter than what counts, like the second press.
    values["lost"][12345] = values["late"][21000] = 1
    values["pixel_clock"][2 * ROUND : 3 * ROUND] = np.arange(ROUND) // 100 & 1
    values["frame"] = 250 + np.arange(clocks) // 300
    which = np.arange(clocks) % len(REGISTERS_SHOWN)
    value = np.choose(which, [values.pop(name) for name in REGISTERS_SHOWN])
    return Program(clocks, which=which, value=value, **values)


@pytest.fixture(scope="module", params=["verilator", "icarus"])
def rows(request, given):
    if reason := missing(request.param):
        pytest.skip(reason)
    return Run(_Bench())(given, request.param)


def at_end(rows, number):
    return rows[(number + 1) * ROUND - 1]


def test_switches(rows):
    """To registers and to the camera, once each has lasted; nothing is written twice."""
    for number, phase in enumerate(PHASES):
        row, switches = at_end(rows, number), phase["switches"]
        assert row["taken"] == switches and row["threshold"] == (switches & 255 or AUTOMATIC)
        control = system_maps(CONFIG)["sensor"][1].register("control")
        assert row["control"] == 1 << control.field("enable").low | (switches >> 8 & 1) << control.field("bright").low
        assert row["exposure"] == 8 * (switches >> 9 & 127) + 4
        assert row["gain"] == (8, 16, 32, 96)[switches >> 16]
    assert rows["writes"][-1] == 2 + 2 + 2 + 2  # Threshold and the foreground's kind change in each phase.
    changes = np.flatnonzero(np.diff(rows["taken"].astype(np.int64)))
    assert len(changes) < 8 and (changes % ROUND < 120).all()


def test_key(rows):
    """One strobe for each press that lasts."""
    strobes = np.flatnonzero(rows["restart"])
    assert len(strobes) == 2 and 5000 < strobes[0] < 5020 and 20000 < strobes[1] < 20020


def test_digits(rows):
    """Markers and cut frames, and all nines where they have no room."""
    markers = [decimal(int(at_end(rows, number)["digits"]), [4, 5]) for number in range(len(PHASES))]
    assert markers == [3, 64, 99, 0]
    cut = [decimal(int(at_end(rows, number)["digits"]), [0, 1, 2, 3]) for number in range(len(PHASES))]
    assert cut == [1, 4321, 9999, 0]


def test_frames_in_a_second(rows):
    """From the third second on; as this one is hardly longer than a round of the registers, it is frames of a round.

    The lowest bits of their counter go through 0 meanwhile.
    """
    rates = {decimal(int(rows[clock]["digits"]), [6, 7]) for clock in range(2 * SECOND + 2000, len(rows), 500)}
    assert rates and rates <= {26, 27, 28}


def test_lights(rows):
    lights = rows["lights"]
    for number, phase in enumerate(PHASES):
        row = int(at_end(rows, number)["lights"])
        assert (row & 1, row >> 1 & 1, row >> 6 & 1) == tuple(
            phase.get(name, 0) for name in ("camera_done", "camera_failed", "irq")
        )
        assert not row >> 4 & 3
    for bit, clock in ((2, 12345), (3, 21000)):  # Kept since then.
        assert not (lights[:clock] >> bit & 1).any() and (lights[clock + 2 :] >> bit & 1).all()
    heart = np.flatnonzero(np.diff(lights.astype(int) >> 7 & 1)) + 1
    assert (np.diff(heart) == SECOND).all() and len(heart) == len(rows) // SECOND - (len(rows) % SECOND == 0)
    runs = [int(lights[number * SECOND + 100]) >> 8 & 1 for number in range(len(rows) // SECOND)]
    assert runs == [0, 0, 0, 1]  # In the second after the one in which it ran.
