"""Any component with registers, driven and seen in every clock; and its replay by a model that takes steps."""

import types

import numpy as np
from amaranth import Module
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import unstalled
from sim.engine import StreamEngine, fields, pack
from tests.hdl.harness import cocotb_run

__all__ = ["PeripheralBench", "Program", "Run", "check", "random_traffic"]

_BUS = {"address": 8, "read": 1, "write": 1, "write_data": 32}


class PeripheralBench(wiring.Component):
    """A component whose plain inputs and register bus come as one stream, and whose outputs leave as another."""

    def __init__(self, part):
        self._part = part
        given, seen = {}, {}
        for name, member in part.signature.members.items():
            if name == "bus":
                given |= _BUS
                seen["read_data"] = 32
            elif member.is_port:
                (given if member.flow == In else seen)[name] = member.shape
            elif isinstance(member.signature, stream.Signature):
                seen |= {f"{name}.valid": 1, f"{name}.payload": member.signature.members["payload"].shape}
        self.given, self.seen = data.StructLayout(given), data.StructLayout(seen)
        super().__init__({"i": In(unstalled(self.given)), "o": Out(unstalled(self.seen))})

    def elaborate(self, platform):
        m = Module()
        m.submodules.part = part = self._part
        given, seen = self.i.payload, self.o.payload
        m.d.comb += self.o.valid.eq(1)
        for name in self.given.members:
            value = given[name] & self.i.valid if name in ("read", "write") else given[name]
            m.d.comb += getattr(part.bus if name in _BUS else part, name).eq(value)
        for name in self.seen.members:
            source = part
            for attribute in ("bus." * (name == "read_data") + name).split("."):
                source = getattr(source, attribute)
            m.d.comb += seen[name].eq(source)
        return m


class Program:
    """What a component is given in each of ``clocks`` clocks: transfers on its bus, and ``pins`` by their names."""

    def __init__(self, clocks, **pins):
        self.clocks = clocks
        self.values = {name: np.zeros(clocks, np.int64) for name in _BUS} | pins
        self.resets = ()

    def write(self, clock, address, value):
        """A write, in a clock without another transfer. The address is in bytes."""
        self._transfer(clock, address, write=1, write_data=value)

    def read(self, clock, address):
        """A read; what it brings is in row ``clock`` + 2 of the run."""
        self._transfer(clock, address, read=1)

    def _transfer(self, clock, address, **values):
        assert not self.values["read"][clock] and not self.values["write"][clock], f"clock {clock} is taken"
        for name, value in ({"address": address // 4} | values).items():
            self.values[name][clock] = value

    def transfers(self):
        """For each clock: ``(byte address, data)`` of a write or None, byte address of a read or None."""
        columns = (self.values[name].tolist() for name in ("address", "write_data", "write", "read"))
        return [
            ((4 * address, value) if write else None, 4 * address if read else None)
            for address, value, write, read in zip(*columns, strict=True)
        ]


class Run:
    """Runs programs on one component: fast, or in a simulator."""

    def __init__(self, part):
        self._bench = PeripheralBench(part)
        self._engine = None

    def __call__(self, program, simulator=None):
        """What is seen in each clock of a program, from a reset on; clocks of its resets are not counted."""
        bench = self._bench
        given = {"i": pack(bench.given, **{name: program.values[name] for name in bench.given.members})}
        if simulator:
            run = cocotb_run(bench, simulator, given, reset_at=program.resets)
        else:
            self._engine = self._engine or StreamEngine(bench)
            self._engine.reset()
            run = self._engine.run(given, reset_at=program.resets)
        return fields(run["o"], bench.seen)[: program.clocks]


def random_traffic(program, random, choices, *, busy=0.5):
    """Fill a program's bus: ``choices`` has byte address -> what makes a value to write, or None to read only."""
    addresses = list(choices)
    for clock in np.flatnonzero(random.random(program.clocks) < busy).tolist():
        address = addresses[random.integers(len(addresses))]
        make = choices[address]
        if make is None or random.random() < 0.5:
            program.read(clock, address)
        else:
            program.write(clock, address, int(make(random)))


def check(make_model, program, rows):
    """Replay a run.

    A model has ``pins()``, name -> value in this clock; ``look(address)``, what a read brings that looks in this
    clock, as a number, as the set of all that would be right, or as None where nothing is promised; and
    ``step(write, pins)`` to the next clock.
    """
    model, looked, read_before = make_model(), {0}, None
    names = [name for name in program.values if name not in _BUS]
    for clock, (write, read) in enumerate(program.transfers()):
        if clock in program.resets:
            model, looked, read_before = make_model(), {0}, None
        row = rows[clock]
        for name, value in model.pins().items():
            assert row[name] == value, (clock, name, int(row[name]), value)
        assert looked is None or int(row["read_data"]) in looked, (clock, hex(row["read_data"]), looked)
        value = 0 if read_before is None else model.look(read_before)
        looked, read_before = {value} if isinstance(value, int | bool) else value, read
        model.step(write, types.SimpleNamespace(**{name: int(program.values[name][clock]) for name in names}))
    return model
