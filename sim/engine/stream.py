"""One block, alive, with streams in and streams out."""

import ctypes
import pathlib
import re

import numpy as np

from hdl import emit
from sim.engine.build import EngineError, build_library
from sim.engine.plan import Captured, Run, make_plan
from sim.engine.ports import describe, resolve

__all__ = ["StreamEngine"]

_DRIVER = pathlib.Path(__file__).with_name("driver.cpp")


class _Schedule(ctypes.Structure):
    """The layout of ``Schedule`` in driver.cpp."""

    _fields_ = (
        ("clocks", ctypes.c_int64),
        ("beat_count", ctypes.c_void_p),
        ("beat_clock", ctypes.c_void_p),
        ("beat_payload", ctypes.c_void_p),
        ("change_count", ctypes.c_int64),
        ("change_clock", ctypes.c_void_p),
        ("change_port", ctypes.c_void_p),
        ("change_value", ctypes.c_void_p),
        ("reset_count", ctypes.c_int64),
        ("reset_clock", ctypes.c_void_p),
    )


def _member(name):
    """The C++ member of a port: Verilator spells two underscores in its own way."""
    return "dut." + name.replace("__", "___05F")


def _switch(head, cases, default=""):
    body = "".join(f"    case {index}: {case}\n" for index, case in enumerate(cases))
    return f"static inline {head} {{\n    switch (index) {{\n{body}    }}\n{default}}}\n"


def _test(port):
    """C++ expression that is true when a plain output is not zero."""
    member = _member(port.name)
    return " | ".join(f"{member}[{word}]" for word in range(port.words)) if port.width > 64 else member


def _read(name, port):
    member = _member(name)
    if port.width > 64:
        values = [f"{member}[{word}]" for word in range(port.words)]
    else:
        values = [f"static_cast<uint32_t>({member} >> {32 * word})" for word in range(port.words)]
    return " ".join(f"words[{word}] = {value};" for word, value in enumerate(values)) + " break;"


def ports_header(interface, verilog):
    """ports.h: what driver.cpp has to know about one block."""

    def assign(port):  # A block without registers has neither clock nor reset.
        present = re.search(rf"^  input {port};", verilog, re.MULTILINE)
        return f"{_member(port)} = level;" if present else ""

    words = ", ".join(str(port.words) for port in interface.captured)
    drive = [
        f"{_member(port.name + '__valid')} = valid; {_member(port.name + '__payload')} = "
        f"payload & {port.mask:#x}u; break;"
        for port in interface.inputs
    ]
    configure = [f"{_member(port.name)} = value; break;" for port in interface.settings]
    valid = [f"return {_member(port.name + '__valid')};" for port in interface.outputs]
    valid += [f"return {_test(port)};" for port in interface.strobes]
    read = [_read(port.name + "__payload", port) for port in interface.outputs]
    read += [_read(port.name, port) for port in interface.strobes]
    return "".join(
        (
            '#pragma once\n#include "Vdut.h"\nusing Dut = Vdut;\n',
            f"constexpr int INPUTS = {len(interface.inputs)};\n",
            f"constexpr int CAPTURES = {len(interface.captured)};\n",
            f"constexpr int WORDS[] = {{{words}}};\n",
            f"static inline void set_clock(Dut& dut, bool level) {{ {assign('clk')} }}\n",
            f"static inline void set_reset(Dut& dut, bool level) {{ {assign('rst')} }}\n",
            _switch("void drive(Dut& dut, int index, bool valid, uint64_t payload)", drive),
            _switch("void configure(Dut& dut, int index, uint64_t value)", configure),
            _switch("bool is_valid(Dut& dut, int index)", valid, "    return false;\n"),
            _switch("void read(Dut& dut, int index, uint32_t* words)", read),
        )
    )


class StreamEngine:
    """A block's emitted Verilog, compiled, reset and ready to run.

    It can run every block whose ports are ``clk`` and ``rst``, plain inputs of up to 64 bits (*settings*),
    streams that are ``always_ready`` with payloads of up to 64 bits in and 1024 bits out, and plain outputs
    (*strobes*). All of them are found in the block's signature. An engine is used by one thread at a time;
    any number of engines and processes may run side by side.

    Parameters
    ----------
    block : str, component or callable
        Name in :data:`hdl.emit.BLOCKS`, an Amaranth component, or a callable that makes one from
        ``(width, height)``.
    width, height : int
        Largest frame in pixels.

    Raises
    ------
    EngineError
        If the engine cannot be built.
    """

    def __init__(self, block, width=640, height=480):
        self._handle = None
        self.name, component = resolve(block, width, height)
        self.interface = describe(component)
        self.verilog = emit.to_verilog(component, self.name)
        if not self.interface.captured:
            raise EngineError(f"Block {self.name!r} has no outputs")
        header = ports_header(self.interface, self.verilog)
        path = build_library(self.verilog, self.name, {"driver.cpp": _DRIVER.read_text(), "ports.h": header})
        self._library = ctypes.CDLL(str(path))
        for name, result in (
            ("new", ctypes.c_void_p),
            ("count", ctypes.c_int64),
            ("payload", ctypes.POINTER(ctypes.c_uint32)),
            ("clock", ctypes.POINTER(ctypes.c_int64)),
            ("delete", None),
            ("reset", None),
            ("run", None),
        ):
            getattr(self._library, f"engine_{name}").restype = result
        self._set = set()
        self._handle = ctypes.c_void_p(self._library.engine_new())
        self.reset()

    def __del__(self):
        if self._handle:
            self._library.engine_delete(self._handle)

    def reset(self):
        """Pulse ``rst`` for one clock. Memories and settings keep their contents."""
        self._library.engine_reset(self._handle)

    def run(self, inputs, config=None, *, drain_clocks=64, reset_at=()):
        """Feed beats, then let the block run on, and return all that came out.

        The block goes on from where the last run left it; clocks count from 0 again.

        Parameters
        ----------
        inputs : dict
            Input stream -> payloads (integers), or ``(payloads, idle)`` where ``idle`` is None, a number or
            an array: the clocks without a beat before each one. The payload is junk in these. Streams left
            out stay idle.
        config : dict
            Setting -> value from the first clock on, or a list of ``(beat, value)``: the value from the clock
            on in which that beat of the *first* input stream is driven. A setting not named keeps the value
            of the run before.
        drain_clocks : int
            Clocks to run on after the last beat.
        reset_at : list of int
            Beats of the first input stream before which ``rst`` is pulsed: one clock in which no stream has a
            beat and no output is captured.

        Returns
        -------
        Run
            Output stream -> :class:`Captured`, one row a beat; and plain output -> one row for each clock in
            which it was not zero. ``.clocks``, ``.accepted`` and ``.resets`` tell when things happened.
        """
        plan = make_plan(self.interface, inputs, config, drain_clocks=drain_clocks, reset_at=reset_at)
        self._set |= set(config or {})
        unset = [port.name for port in self.interface.settings if port.name not in self._set]
        if unset:
            raise ValueError(f"Settings without a value: {', '.join(unset)}")
        beats = [(np.ascontiguousarray(clock), payload) for clock, payload in plan.beats.values()]
        pointers = ctypes.c_void_p * len(beats)
        counts = (ctypes.c_int64 * len(beats))(*(len(clock) for clock, _ in beats))
        clocks, payloads = (pointers(*(pair[index].ctypes.data for pair in beats)) for index in (0, 1))
        schedule = _Schedule(
            plan.clocks,
            ctypes.addressof(counts),
            ctypes.addressof(clocks),
            ctypes.addressof(payloads),
            len(plan.change_clock),
            *(array.ctypes.data for array in (plan.change_clock, plan.change_port, plan.change_value)),
            len(plan.resets),
            plan.resets.ctypes.data,
        )
        self._library.engine_run(self._handle, ctypes.byref(schedule))
        return Run(
            {port.name: self._captured(index, port) for index, port in enumerate(self.interface.captured)},
            plan,
        )

    def _captured(self, index, port):
        count = self._library.engine_count(self._handle, index)
        if not count:
            return Captured(np.zeros((0, port.words), dtype=np.uint32), np.zeros(0, dtype=np.int64))
        payload = np.ctypeslib.as_array(self._library.engine_payload(self._handle, index), (count, port.words))
        clock = np.ctypeslib.as_array(self._library.engine_clock(self._handle, index), (count,))
        return Captured(payload.copy(), clock.copy())
