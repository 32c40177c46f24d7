"""Accesses for blocks with memory buses, their runs in a simulator, and the rules that every bus has to keep."""

import numpy as np
from amaranth import Const, Value

from hdl.emit import to_verilog
from sim.models.memory import LINE, Answer, Request
from tests.hdl.harness import simulate

__all__ = ["accesses", "answer", "check_protocol", "play", "request"]


def _ports(component):
    for path, _, value in component.signature.flatten(component):
        if not isinstance(Value.cast(value), Const):
            yield "__".join(path)


def play(component, name, simulator, clocks, *, rows=None, waits=None, registers=(), pins=None, resets=()):
    """Run a component for so many clocks; returns a record of all its ports for each, -1 where one is X.

    Parameters
    ----------
    rows : dict
        Requester -> its :func:`accesses`.
    waits : dict
        Memory, that is, a bus that the component makes requests on -> clocks until it answers each.
    registers : sequence of str
        Register buses that the component is the master of.
    pins : dict
        Other input -> its value in each clock.
    resets : sequence of int
        Clocks with ``rst``. The requests of that clock are forgotten in the next.
    """
    rows, waits, pins = rows or {}, waits or {}, pins or {}
    ports = list(_ports(component))
    arrays = {"clocks": clocks, "resets": np.array(resets, np.int64), "ports": ports}
    for kind, names in (("requesters", rows), ("memories", waits), ("registers", registers), ("pins", pins)):
        arrays[kind] = np.array(list(names), dtype=str)
    for kind, values in (("rows", rows), ("waits", waits), ("pin", pins)):
        arrays |= {f"{kind}.{key}": np.asarray(value, np.int64) for key, value in values.items()}
    verilog = to_verilog(component, name)
    captured = simulate(name, verilog, simulator, arrays, size="memory", testbench="tests.hdl.tb_memory_bus")
    trace = captured["trace"]
    return np.rec.fromarrays(trace.T, names=[port.replace("__", ".") for port in ports])


def accesses(random, count, *, starts, idle=0.5, longest=6, writes=0.4, lines=0.3):
    """Random accesses: singles, and reads of whole lines as the processor's caches make them.

    Parameters
    ----------
    starts : sequence of int
        First addresses of lines, in words, in which they lie.
    idle, writes, lines : float
        Chance of idle clocks before an access, up to ``longest``; of a write; and of a line among reads.
    """
    start = random.choice(starts, count)
    is_write = random.random(count) < writes
    is_line = ~is_write & (random.random(count) < lines)
    return np.stack(
        [
            np.where(random.random(count) < idle, random.integers(1, longest + 1, count), 0),
            is_write,
            start + np.where(is_line, 0, random.integers(0, LINE, count)),
            np.where(is_line, LINE, 1),
            np.where(random.random(count) < 0.5, 15, random.integers(0, 16, count)),
            random.integers(0, 1 << 32, count),
        ],
        axis=-1,
    )


def request(row, name):
    """Request of a bus in a clock of a run."""
    return Request(*(int(row[f"{name}.{field}"]) for field in Request._fields))


def answer(row, name):
    """Answer on a bus in a clock of a run; its data as they are, with or without ack."""
    return Answer(*(int(row[f"{name}.{field}"]) for field in Answer._fields))


def check_protocol(trace, name, resets=()):
    """Rules of :class:`~hdl.system.memory_bus.MemoryBus` for who answers; returns each answered request's
    (clock, Request, data)."""
    done, begun = [], None
    for clock, row in enumerate(trace):
        now, ack = request(row, name), int(row[f"{name}.ack"])
        assert ack in (0, 1), f"{name}.ack is X in clock {clock}"
        assert now.valid or not ack, f"{name} was acknowledged without a request in clock {clock}"
        if now.valid and begun is None:
            begun = clock
        if ack:
            follows = done and done[-1][0] == clock - 1 and done[-1][1].burst
            assert begun < clock or follows, f"{name} was acknowledged in the first clock of its request, {clock}"
            data = int(row[f"{name}.read_data"])
            assert now.write or data >= 0, f"{name}.read_data is X in clock {clock}"
            done.append((clock, now, data))
            begun = None
        if clock in resets:
            begun = None
    return done
