"""The sensor behind Avalon interfaces, driven by cocotbext-avalon: same results as the model, every fault counted.

What must come out follows from the models one after the other: packets to pixels, pixels to frames, frames to results.
Icarus makes a few hundred clocks of the whole in a second, so it plays one program; test_avalon_video_input.py has it
play packets of every kind.
"""

import numpy as np
import pytest

from hdl import emit
from hdl.config import SensorConfig
from hdl.regs.map import avalon_maps
from sim.engine.build import cached_verilog
from sim.engine.frames import marker_words
from sim.models.avalon_video_input import ERRORS, avalon_video_input, control_packet, packet, video_packet
from sim.models.sensor import ModelSensor
from sim.scene import random_marker_scene, render
from tests.hdl.harness import missing, simulate
from tests.system.tb_avalon import Op
from tests.system.test_sensor_protocol import COUNTERS, complete_frames

SIZE = WIDTH, HEIGHT = 64, 48
MAPS = avalon_maps(SensorConfig(width=WIDTH, height=HEIGHT))
ALL_BYTES = 0b1111
#: Clocks in which one candidate is matched and its frame published.
MATCHING = 400
#: Control packets' interlacing nibble of a field.
FIELD = 0b1010


def address(name):
    """Byte address of a register or a window."""
    for offset, part in MAPS.values():
        for entry in (*part.registers, *part.windows):
            if entry.name == name:
                return offset + entry.offset
    raise KeyError(name)


def bit(register, field):
    return 1 << MAPS["sensor"][1].register(register).field(field).low


def scene(seed, width=WIDTH, height=HEIGHT):
    """A rendered marker."""
    found = random_marker_scene(seed, width, height, side_px=(22, 24), tilt_deg=(0, 30), noise_sigma=2)
    return render(found).image


class Program:
    """What the source sends and software does, and beside it what every read must bring."""

    def __init__(self):
        self._rows, self.packets, self.expected = [], [], []
        self._forget()

    def _forget(self):
        self._sent, self._columns, self._rows_of_frame = [], WIDTH, HEIGHT

    def do(self, op, *arguments):
        self._rows.append([op, *arguments, 0, 0, 0][:4])

    def send(self, beats):
        symbols = [word >> shift & 255 for word, *_ in beats for shift in (0, 8, 16)]
        self.do(Op.SEND, len(self.packets))
        self.packets.append(symbols)
        self._sent += beats

    def write(self, name, value, enables=ALL_BYTES):
        self.do(Op.WRITE, address(name), value, enables)

    def read(self, name, value, note=""):
        self.do(Op.READ, address(name))
        self.expected.append((note or name, value))

    def resize(self, columns, rows):
        self.do(Op.CLOCKS, WIDTH + 64 + 10)  # Until the frame before is settled.
        self._columns, self._rows_of_frame = columns, rows
        self.write("frame_size", columns | rows << 16)

    def start(self):
        self.write("irq_enable", bit("irq_enable", "published"))

    def reset(self):
        self.do(Op.RESET, 3)
        self._forget()
        self.start()

    def published(self):
        """Wait until all is sent and published, hold the frame, read it: it is the last complete one."""
        images, _ = self.frames()
        (result,) = ModelSensor(*SIZE).run(images[-1:])
        self.do(Op.SENT)
        self.do(Op.CLOCKS, MATCHING)
        self.do(Op.IRQ)
        self.write("control", bit("control", "enable") | bit("control", "hold"))
        self.do(Op.UNTIL, address("status"), bit("status", "held"))
        self.read("frame", len(images) - 1)
        for name in ("markers", "corners", "blobs"):
            self.read(name, len(getattr(result, name)))

        self.reads("marker_window", [word for marker in result.markers for word in marker_words(marker)])
        corners = result.corners[:20]
        self.reads(
            "corner_window",
            [
                word
                for corner in corners
                for word in (
                    int(corner["x"]) | int(corner["y"]) << 16,
                    int(corner["score"]) | int(corner["arc"]) << 8 | int(corner["bright"]) << 16,
                )
            ],
        )
        self.write("irq_status", bit("irq_status", "published"))
        self.write("control", bit("control", "enable"))
        return result

    def reads(self, name, words):
        """One read in every clock."""
        self.do(Op.READS, address(name), len(words))
        self.expected += [(f"{name}[{k}]", word) for k, word in enumerate(words)]

    def frames(self):
        """(pictures of the complete frames that were sent, counters of the wrong ones)."""
        if not self._sent:
            return [], dict.fromkeys(COUNTERS.values(), 0)
        pixels = avalon_video_input(self._sent, WIDTH).pixels(self._sent).astype(np.uint32)
        images, _, errors = complete_frames(pixels, self._columns, self._rows_of_frame, SIZE)
        return images, errors

    def counters(self):
        """Every counter, by the models."""
        self.do(Op.SENT)
        images, errors = self.frames()
        said = avalon_video_input(self._sent, WIDTH)
        packets = sum(len(said.errors[kind]) << 8 * place for place, kind in enumerate(ERRORS))
        self.read("packet_errors", packets)
        for name in COUNTERS.values():
            self.read(name, errors[name])
        self.read("frames_complete", len(images))
        width, height, interlacing = said.sizes[-1][1:] if said.sizes else (0, 0, 0)
        self.read("video_size", width | height << 16)
        self.read("video_kind", interlacing | bool(said.sizes) << 8)
        return errors

    def run(self, simulator):
        sizes = [len(symbols) for symbols in self.packets]
        captured = simulate(
            emit.AVALON,
            cached_verilog(emit.AVALON, *SIZE),
            simulator,
            {
                "program": np.array(self._rows),
                "packets": np.concatenate(self.packets),
                "packet_sizes": sizes,
                "patience": 20_000,
            },
            size=f"{WIDTH}x{HEIGHT}",
            testbench="tests.system.tb_avalon",
        )
        log = captured["log"].tolist()
        for place, ((note, value), got) in enumerate(zip(self.expected, log, strict=True)):
            assert got == value, f"read {place}, {note}: {got:#x} instead of {value:#x}"


CONTROL = control_packet(*SIZE)


@pytest.fixture
def verilator():
    """The simulator of that name, where it is."""
    if reason := missing("verilator"):
        pytest.skip(reason)
    return "verilator"


def test_frames(verilator):
    """Single, with idle clocks, back to back, without control packets, after user packets; then a reset within one."""
    program = Program()
    program.start()
    program.read("video_size", 0)
    found = []
    for percent, seeds in ((0, [1]), (40, [2]), (0, [3, 4])):
        program.do(Op.PAUSE, percent)
        program.send(packet(5, [1, 2, 3]))
        for seed in seeds:
            program.send(CONTROL if seed != 4 else packet(1, []))
            program.send(video_packet(scene(seed)))
            if seed == 3:
                continue
            found.append(program.published())
    errors = program.counters()
    assert not any(errors.values())
    program.do(Op.SEEN)
    program.expected.append(("packets seen by the monitor", len(program.packets)))

    program.send(video_packet(scene(5)))
    program.do(Op.CLOCKS, 1000)
    program.reset()
    program.counters()
    colour = np.stack([scene(6), scene(6) // 2 + 60, scene(6)], axis=2)
    program.send(video_packet(colour))
    found.append(program.published())
    program.do(Op.LEVEL)
    program.expected.append(("interrupt after it was cleared", 0))
    assert all(len(result.markers) == 1 for result in found), [len(result.markers) for result in found]
    program.run(verilator)


def test_wrong_packets(verilator):
    """Control packets short, repeated and interlaced; frames of every wrong size, each followed by a good one."""
    program = Program()
    program.start()
    good = video_packet(scene(7))
    wide, narrow = scene(8, WIDTH + 6), scene(8)[:, :-4]
    parts = [
        [packet(15, []), packet(15, [7, 7]), good],
        [control_packet(20, 20), packet(2, [15]), CONTROL, good],
        [control_packet(WIDTH, HEIGHT // 2, FIELD), video_packet(scene(8)[::2]), packet(15, [1]), good, CONTROL, good],
        [control_packet(WIDTH - 4, HEIGHT), video_packet(narrow), CONTROL, good],
        [control_packet(WIDTH + 6, HEIGHT), video_packet(wide), CONTROL, good],
        [control_packet(WIDTH - 4, HEIGHT), good, CONTROL, good],
        [video_packet(scene(8)[:-5]), good],
        [video_packet(np.concatenate([scene(7), scene(7)[:2]])), good],
        [good[:1000] + [(5, 0, 1)], good],
        [good[:1] + [(5, 0, 1)], packet(0, []), good],
    ]
    program.do(Op.PAUSE, 3)
    for part in parts:
        for beats in part:
            program.send(beats)
        program.published()
    errors = program.counters()
    assert all(errors[name] for name in ("short_lines", "long_lines", "short_frames", "long_frames")), errors
    program.run(verilator)


def test_registers(large_simulator):
    """Whole words are written, parts refused and counted; software takes over the video's size; then a reset."""
    program = Program()
    program.start()
    program.write("threshold", 77)
    for enables, value in ((0b0001, 1), (0b0011, 2), (0b1110, 3), (0, 4)):
        program.write("threshold", value, enables)
    program.read("threshold", 77)
    program.read("bus_errors", 3)
    program.write("bus_errors", 0)
    program.read("bus_errors", 0)
    program.write("threshold", 120)
    program.reads("id", [0x52504F53, 0x100, WIDTH | HEIGHT << 16, 1])
    program.read("default_line", WIDTH)
    program.write("default_line", 56)
    program.read("default_line", 56)
    program.send(control_packet(56, 44))
    program.do(Op.SENT)
    program.read("video_size", 56 | 44 << 16)
    program.resize(56, 44)
    program.send(video_packet(scene(9, 56, 44)))
    result = program.published()
    assert len(result.markers) == 1
    program.counters()
    program.send(video_packet(scene(9, 56, 44)))
    program.do(Op.CLOCKS, 200)
    program.reset()
    program.read("threshold", 120)
    program.read("default_line", WIDTH)
    program.counters()
    program.run(large_simulator)


def test_default_line(verilator):
    """A source that sends no control packets."""
    program = Program()
    program.start()
    program.write("default_line", 56)
    program.resize(56, 44)
    frame = scene(9, 56, 44)
    program.send(packet(3, []))
    program.send(video_packet(frame))
    (result,) = ModelSensor(*SIZE).run([frame])
    program.do(Op.IRQ)
    program.read("markers", len(result.markers))
    program.read("frames_complete", 1)
    assert len(result.markers) == 1
    program.run(verilator)


def test_constructor_error():
    with pytest.raises(ValueError, match="width must be 16 to 4096 pixels, not 8"):
        emit.build(emit.AVALON, 8, 48)
