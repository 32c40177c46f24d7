"""The register bank, all of it in view; a dictionary that does the same; what registers there must be."""

import numpy as np
from amaranth import Cat, Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.config import SensorConfig
from hdl.pixels import unstalled
from hdl.regs.bank import RegisterBank
from hdl.regs.bus import EARLY_LATENCY, READ_LATENCY
from hdl.regs.map import Behaviour, sensor_map
from sim.engine import fields
from sim.models.counters import Counters

__all__ = ["BUS", "CONFIG", "REGISTERS", "WINDOWS", "BankBench", "check", "sensor_bench"]

CONFIG = SensorConfig(width=64, height=48)
C, S, V, F, N = "constant", "setting", "value", "flag", "counter"
TAKEN, COMMAND, PULSE = "taken", "command", "pulse"

#: What there must be: name -> (offset, {field: (low, width, behaviour, reset)}).
REGISTERS = {
    "id": (0x00, {"magic": (0, 32, C, 0x52504F53)}),
    "version": (0x04, {"patch": (0, 8, C, 0), "minor": (8, 8, C, 1), "major": (16, 8, C, 0)}),
    "limits": (0x08, {"width": (0, 16, C, CONFIG.width), "height": (16, 16, C, CONFIG.height)}),
    "control": (0x0C, {"enable": (0, 1, S, 1), "hold": (1, 1, S, 0), "bright": (2, 1, S, 0)}),
    "status": (0x10, {"valid": (0, 1, V, 0), "held": (1, 1, V, 0), "pending": (2, 1, V, 0)}),
    "flags": (
        0x14,
        {
            f"{name}_overflow": (bit, 1, F, 0)
            for bit, name in enumerate(("blob", "corner", "marker", "candidate", "queue", "refining"))
        },
    ),
    "frame_size": (0x18, {"columns": (0, 16, S, CONFIG.width), "rows": (16, 16, S, CONFIG.height)}),
    "threshold": (0x1C, {"level": (0, 8, S, 120), "automatic": (8, 1, S, 0)}),
    "fast": (0x20, {"threshold": (0, 8, S, 20), "n": (8, 4, S, 10), "max_arc": (16, 5, S, 16)}),
    "blob_min": (0x24, {"width": (0, 16, S, 8), "height": (16, 16, S, 8)}),
    "blob_min_area": (0x28, {"pixels": (0, 32, S, 64)}),
    "marker_min": (0x2C, {"side": (0, 16, S, 16)}),
    "irq_enable": (0x30, {"published": (0, 1, S, 0), "marker": (1, 1, S, 0)}),
    "irq_status": (0x34, {"published": (0, 1, F, 0), "marker": (1, 1, F, 0)}),
    "hold": (0x38, {"keep": (0, 1, S, 0)}),
    "edge": (0x3C, {"contrast": (0, 8, S, 16)}),
    "frame": (0x40, {"number": (0, 32, V, 0)}),
    "live": (0x44, {"frame": (0, 16, V, 0), "markers": (16, 16, V, 0)}),
    "blobs": (0x48, {"count": (0, 16, V, 0), "dropped": (16, 16, V, 0)}),
    "blobs_small": (0x4C, {"count": (0, 16, V, 0)}),
    "corners": (0x50, {"count": (0, 16, V, 0), "dropped": (16, 16, V, 0)}),
    "markers": (0x54, {"count": (0, 16, V, 0), "dropped": (16, 16, V, 0)}),
    "candidates_dropped": (0x58, {"count": (0, 16, V, 0)}),
    "level": (0x5C, {"threshold": (0, 8, V, 0)}),
    "time": (0x60, {"clocks": (0, 32, V, 0)}),
    "first_pixel": (0x64, {"clocks": (0, 32, V, 0)}),
    "last_pixel": (0x68, {"clocks": (0, 32, V, 0)}),
    "marker_address": (0xA0, {"marker": (0, 8, S, 0)}),
    **{f"x{k + 1}": (0xC0 + 8 * k, {"column": (0, 16, V, 0)}) for k in range(4)},
    **{f"y{k + 1}": (0xC4 + 8 * k, {"row": (0, 16, V, 0)}) for k in range(4)},
} | {
    name: (0x80 + 4 * k, {"count": (0, 32, N, 0)})
    for k, name in enumerate(
        (
            "frames_complete",
            "frames_skipped",
            "short_lines",
            "long_lines",
            "short_frames",
            "midline_starts",
            "long_frames",
            "bad_sizes",
        )
    )
}
_POINT = {"x": (0, 16), "y": (16, 16)}
_FLAGS = ("refined", "few", "lost", "border", "clipped", "astray")
_QUALITY = {"residual": (0, 12), "points": (12, 12), **{name: (24 + k, 1) for k, name in enumerate(_FLAGS)}}
_MARKER = [_POINT] * 6 + [{"pixels": (0, 32)}] * 2 + [_POINT] * 4 + [_QUALITY, {}, {}, {}]
#: Name -> (offset, items, fields of each word, name of the item).
WINDOWS = {
    "marker_window": (0x1000, 64, _MARKER, "marker"),
    "live_window": (0x2000, 64, _MARKER, "marker"),
    "blob_window": (0x4000, 256, [_POINT, _POINT, {"pixels": (0, 32)}, {}], "blob"),
    "corner_window": (0x8000, 1024, [_POINT, {"score": (0, 8), "arc": (8, 5), "bright": (16, 1)}], "corner"),
}
#: Something that tells the items of one register file from those of another.
ITEMS = {"marker": 0x1000, "blob": 0x4000, "corner": 0x8000}
BUS = data.StructLayout({"address": 14, "read": 1, "write": 1, "write_data": 32})


def mixed(number, key, width):
    """Something that tells one field, item or clock from another."""
    return (number * (2 * key + 3) * 0x9E37 + key * 0x3779) & (1 << width) - 1


def _told(field):
    """Ports by which a field tells what software does, and their widths."""
    match field.behaviour:
        case Behaviour.SETTING | Behaviour.PULSE:
            return {field.name: field.width}
        case Behaviour.COMMAND:
            return {field.name: field.width, f"{field.name}_written": 1}
        case Behaviour.TAKEN:
            return {f"{field.name}_read": 1}
    return {}


class BankBench(wiring.Component):
    """A bank whose inputs change with every clock and whose windows echo their index; its outputs in view."""

    def __init__(self, registers, read_latency=EARLY_LATENCY):
        self._map = registers
        self.read_latency = read_latency
        self._fields = [(r.name, f) for r in registers.registers for f in r.fields]
        told = {f"{name}.{port}": width for name, f in self._fields for port, width in _told(f).items()}
        strobes = sum(f.behaviour in (Behaviour.FLAG, Behaviour.COUNTER) for _, f in self._fields)
        self.seen = data.StructLayout(
            {"read_data": 32, "irq": 1} | told | {f"{window.name}.select": 1 for window in registers.windows}
        )
        super().__init__({"bus": In(unstalled(BUS)), "strobes": In(unstalled(strobes)), "o": Out(unstalled(self.seen))})

    def elaborate(self, platform):
        m = Module()
        m.submodules.bank = bank = RegisterBank(registers=self._map, read_latency=self.read_latency)
        given, seen, clock = self.bus.payload, self.o.payload, Signal(32)
        m.d.sync += clock.eq(clock + 1)
        m.d.comb += [
            bank.bus.address.eq(given.address),
            bank.bus.read.eq(given.read & self.bus.valid),
            bank.bus.write.eq(given.write & self.bus.valid),
            bank.bus.write_data.eq(given.write_data),
            self.o.valid.eq(1),
            seen.read_data.eq(bank.bus.read_data),
            seen.irq.eq(bank.irq),
        ]
        strobes = []
        for name, field in self._fields:
            ports = getattr(bank, name, None)
            match field.behaviour:
                case Behaviour.VALUE | Behaviour.TAKEN:
                    key = self._map.register(name).offset + field.low
                    m.d.comb += getattr(ports, field.name).eq(mixed(clock, key, field.width))
                case Behaviour.FLAG:
                    strobes.append(getattr(ports, f"{field.name}_set"))
                case Behaviour.COUNTER:
                    strobes.append(getattr(ports, f"{field.name}_incr"))
            m.d.comb += [seen[f"{name}.{port}"].eq(getattr(ports, port)) for port in _told(field)]
        m.d.comb += Cat(strobes).eq(self.strobes.payload & self.strobes.valid.replicate(len(strobes)))
        indices = {window.item: Signal(10, name=f"{window.item}_index") for window in self._map.windows}
        for window in self._map.windows:
            ports = getattr(bank, window.name)
            m.d.comb += seen[f"{window.name}.select"].eq(ports.select)
            with m.If(ports.select):
                m.d.sync += indices[window.item].eq(ports.index)
        for item, registers in {window.item: window.registers for window in self._map.windows}.items():
            for register in registers:
                for field in register.fields:
                    if field.behaviour == Behaviour.VALUE:
                        key = ITEMS[item] + 32 * register.offset + field.low
                        m.d.comb += getattr(getattr(getattr(bank.items, item), register.name), field.name).eq(
                            mixed(indices[item], key, field.width)
                        )
        return m


def sensor_bench(width, height):
    return BankBench(sensor_map(SensorConfig(width=width, height=height)), READ_LATENCY)


class Model:
    """A dictionary of fields, one clock at a time."""

    def __init__(self, registers):
        self.fields = {
            (name, field): [offset, *rest]
            for name, (offset, members) in registers.items()
            for field, rest in members.items()
        }
        self.state = {key: rest[4] for key, rest in self.fields.items()}
        self.events = [key for key, rest in self.fields.items() if rest[3] in (F, N)]
        self.counted = [key for key, rest in self.fields.items() if rest[3] == N and rest[2] == 32]
        if len(self.counted) < 2:  # one alone is a register
            self.counted = []
        self.counters = Counters(len(self.counted), 32) if self.counted else None

    def word(self, address, clock):
        """What a read of a byte address brings that looks in this clock."""
        for offset, items, words, name in WINDOWS.values() if len(self.fields) > 10 else ():
            item, word = divmod((address - offset) // 4, len(words))
            if offset <= address and item < items:
                key = ITEMS[name] + 128 * word
                return sum(mixed(item, key + low, width) << low for low, width in words[word].values())
        total = 0
        for key, (offset, low, width, behaviour, _) in self.fields.items():
            if key in self.counted:
                total |= self.counters.data() if offset == address else 0
            elif offset == address and behaviour not in (COMMAND, PULSE):
                value = mixed(clock, offset + low, width) if behaviour in (V, TAKEN) else self.state[key]
                total |= value << low
        return total

    def told(self, write, read):
        """What the fields tell, that is, their ports' values, in a clock with this write after one with this read.

        ``write`` is None or (byte address, data), ``read`` None or a byte address.
        """
        for (name, field), (offset, low, width, behaviour, _) in self.fields.items():
            is_written = write is not None and write[0] == offset
            wrote = write[1] >> low & (1 << width) - 1 if is_written else 0
            if behaviour == S:
                yield f"{name}.{field}", self.state[name, field]
            elif behaviour == PULSE:
                yield f"{name}.{field}", wrote
            elif behaviour == TAKEN:
                yield f"{name}.{field}_read", read == offset
            elif behaviour == COMMAND:
                yield f"{name}.{field}_written", is_written
                if is_written:
                    yield f"{name}.{field}", wrote

    def interrupts(self):
        state = self.state
        return any(state.get(("irq_status", name)) and state["irq_enable", name] for name in ("published", "marker"))

    def _count(self, write, read, strobes):
        events = sum((strobes >> self.events.index(key) & 1) << k for k, key in enumerate(self.counted))
        offsets = [self.fields[key][0] for key in self.counted]
        clears = 1 << offsets.index(write[0]) if write is not None and write[0] in offsets else 0
        self.counters.step(events, clears, offsets.index(read) if read in offsets else 0)

    def step(self, write, read, strobes):
        """``write`` is None or (byte address, data), ``read`` None or a byte address."""
        if self.counters:
            self._count(write, read, strobes)
        for key, (offset, low, width, behaviour, _) in self.fields.items():
            is_written = write is not None and write[0] == offset
            wrote = write[1] >> low & (1 << width) - 1 if is_written else 0
            event = key in self.events and strobes >> self.events.index(key) & 1
            if behaviour == S and is_written:
                self.state[key] = wrote
            elif behaviour == F:
                self.state[key] = self.state[key] & ~wrote | event
            elif behaviour == N and key not in self.counted:
                self.state[key] = event if is_written else min(self.state[key] + event, (1 << width) - 1)


def check(run, given, bench, registers):
    """Replay every clock."""
    model = Model(registers)
    seen, bus = fields(run["o"], bench.seen), fields(given["bus"], BUS)
    strobes = np.asarray(given["strobes"]).tolist()
    latency = bench.read_latency
    looked = [0] * (latency - 1)  # what was read, that many clocks before it is seen
    irq = 0
    for clock, (row, transfer) in enumerate(zip(seen, bus, strict=False)):
        assert row["irq"] == irq, clock
        irq = model.interrupts()
        assert row["read_data"] == looked[-latency + 1], (clock, hex(4 * bus[clock - latency]["address"]))
        before = bus[clock - 1]
        read = 4 * before["address"] if clock and before["read"] else None
        write = (4 * transfer["address"], int(transfer["write_data"])) if transfer["write"] else None
        looked.append(0 if read is None else model.word(read, clock))
        for name, value in model.told(write, read):
            assert row[name] == value, (clock, name)
        for name, (offset, items, words, _) in WINDOWS.items() if len(model.fields) > 10 else ():
            inside = offset <= 4 * transfer["address"] < offset + 4 * items * len(words)
            assert row[f"{name}.select"] == inside, (clock, name)
        model.step(write, 4 * transfer["address"] if transfer["read"] else None, strobes[clock])
    return model
