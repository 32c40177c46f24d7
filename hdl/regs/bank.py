"""Registers as hardware, made from their description.

Contract: every field has the port that its :class:`~hdl.regs.map.Behaviour` asks for, called
``register.field``:

========  ==========================  ======================================================================
SETTING   ``name : Out(width)``       what software wrote last
VALUE     ``name : In(width)``        what software reads
TAKEN     ``name : In(width)``        what software reads
          ``name_read : Out(1)``      a strobe in the clock whose ``name`` is read
COMMAND   ``name : Out(width)``       what software writes, while ``name_written``
          ``name_written : Out(1)``   a strobe in the clock of the write
PULSE     ``name : Out(1)``           a strobe in the clock in which software writes 1
FLAG      ``name_set : In(1)``        sets it; at the same time as software clears it, it stays set
COUNTER   ``name_incr : In(1)``       adds 1; at the same time as software clears it, it becomes 1. Two or
                                      more of 32 bits share a memory, and tell what they have counted some
                                      clocks later: :class:`~hdl.regs.counters.Counters`
CONSTANT  no port
========  ==========================  ======================================================================

A register may have fields to read and others to write in the same bits.

A window has ``window.index``, the number of the item that the bus asks for, and ``window.select``, set if it
is this window that it asks, both in the clock of the address, and takes the item's fields one clock later:
``items.item.register.field``, where ``item`` is the name of its register file. So a memory's read port fits as it is.
Windows of the same register file show the same item: they are ways to one memory. Windows cannot be written.

::

    address -> decoded -> | a bit for each register | -> AND with its fields -> OR of some -> | parts | -.
                                                                                                    OR -> | read_data |
                                items out of memories -> | items | -> AND -> OR of all -------------'

This is the bank with a ``read_latency`` of 3. What comes out of a memory has a register before it is chosen from, and
so have ``external`` registers. With a latency of 2 there are neither these nor the parts. In either case a read tells
how things stood in the clock after its address.

Numbers: see :class:`~hdl.regs.bus.RegisterBus`. ``irq`` is a register: one clock after a flag that is enabled by
its setting.
"""

from functools import reduce
from operator import or_

from amaranth import C, Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.config import SensorConfig
from hdl.regs.bus import EARLY_LATENCY, READ_LATENCY, RegisterBus
from hdl.regs.counters import Counters
from hdl.regs.map import Behaviour, sensor_map

__all__ = ["RegisterBank", "sensor_bank"]


#: Registers of which one is chosen in one clock.
_PART = 8


def _field_ports(fields):
    """Ports of the fields of one register."""
    ports = {}
    for field in fields:
        match field.behaviour:
            case Behaviour.SETTING:
                ports[field.name] = Out(field.width, init=field.reset)
            case Behaviour.VALUE:
                ports[field.name] = In(field.width)
            case Behaviour.TAKEN:
                ports |= {field.name: In(field.width), f"{field.name}_read": Out(1)}
            case Behaviour.COMMAND:
                ports |= {field.name: Out(field.width), f"{field.name}_written": Out(1)}
            case Behaviour.PULSE:
                ports[field.name] = Out(1)
            case Behaviour.FLAG:
                ports[f"{field.name}_set"] = In(1)
            case Behaviour.COUNTER:
                ports[f"{field.name}_incr"] = In(1)
    return ports


def _register_ports(registers):
    """A nested signature for each register that has ports."""
    ports = {register.name: _field_ports(register.fields) for register in registers}
    return {name: Out(wiring.Signature(members)) for name, members in ports.items() if members}


def _window_ports(windows):
    """A nested signature for each window, and for each kind of item."""
    asked = {w.name: wiring.Signature({"index": Out(range(w.count)), "select": Out(1)}) for w in windows}
    items = {w.item: Out(wiring.Signature(_register_ports(w.registers))) for w in windows}
    return {name: Out(signature) for name, signature in asked.items()} | (
        {"items": Out(wiring.Signature(items))} if items else {}
    )


def _any(values):
    """All values joined by OR."""
    return reduce(or_, values, C(0))


def _chosen(words):
    """Of ``(asked, value)`` the one that is asked; 0 if none is."""
    return _any(value & asked.replicate(32) for asked, value in words)


class RegisterBank(wiring.Component):
    """All registers of a map, behind one bus.

    Parameters
    ----------
    registers : RegisterMap
        What there is. Windows may have fields of constants and values only.
    read_latency : int
        2 or 3 clocks.

    Raises
    ------
    ValueError
        If a window has other fields, with another latency, or if counters of 32 bits do not follow each other.

    Members
    -------
    bus : :py:`In(RegisterBus(registers.addr_width))`
        From the processor.
    irq : :py:`Out(1)`
        High while any enabled flag is set.
    ... : one member for each register that has ports, and for each window; see above.
    """

    def __init__(self, *, registers, read_latency=EARLY_LATENCY):
        if read_latency not in (EARLY_LATENCY, READ_LATENCY):
            raise ValueError(f"read_latency must be {EARLY_LATENCY} or {READ_LATENCY} clocks, not {read_latency!r}")
        self._is_early = read_latency == EARLY_LATENCY
        for window in registers.windows:
            for register in window.registers:
                for field in register.fields:
                    if field.behaviour not in (Behaviour.CONSTANT, Behaviour.VALUE):
                        path = f"{window.name}.{register.name}.{field.name}"
                        raise ValueError(f"{path}: a window can only be read")
        self.map = registers
        self._counted = self._counters_in_memory(registers)
        super().__init__(
            {
                "bus": In(RegisterBus(registers.addr_width)),
                "irq": Out(1),
                **_register_ports(registers.registers),
                **_window_ports(registers.windows),
            }
        )

    @staticmethod
    def _counters_in_memory(registers):
        """``[(register, field)]`` of the large counters: none if there is only one."""
        counters = [
            (register, field)
            for register in registers.registers
            for field in register.fields
            if field.behaviour == Behaviour.COUNTER and field.width == 32
        ]
        if len(counters) < 2:  # one has nobody to share a memory with
            return []
        first = counters[0][0].offset
        if any(register.offset != first + 4 * k for k, (register, _) in enumerate(counters)):
            raise ValueError("Counters of 32 bits must follow each other")
        return counters

    def elaborate(self, platform):
        m = Module()
        self._decode(m)
        values = {}  # (register, field) -> what software reads
        words, late = [], self._count(m)  # (asked, value)
        for register in self.map.registers:
            asked = self._asked(m, register.name, self._hit(register.offset // 4))
            word = asked, self._register(m, register, asked, values)
            (late if register.external else words).append(word)
        for item, windows in self._windows().items():
            hits = _any(self.bus.address.matches(self._pattern(window)) for window in windows)
            asked, number = self._asked(m, item, hits), Signal(range(windows[0].stride // 4), name=f"{item}_number")
            m.d.sync += number.eq(self.bus.address)
            late += [
                (asked & (number == register.offset // 4), self._item(item, register))
                for register in windows[0].registers
            ]
        self._connect_windows(m)
        if self._is_early:
            m.d.sync += self.bus.read_data.eq(_chosen(words + late))
        else:
            parts = [_chosen(some) for some in self._some(words)]
            parts = [self._kept(m, part) for part in parts]
            late = [_chosen(some) for some in self._some([self._late(m, *one) for one in late])] or [C(0)]
            late[-1] |= _any(parts)
            m.d.comb += self.bus.read_data.eq(_any([self._kept(m, part) for part in late]))
        interrupts = [
            values[register.name, field.name] & values[field.enable]
            for register in self.map.registers
            for field in register.fields
            if field.enable
        ]
        m.d.sync += self.irq.eq(Cat(interrupts).any())
        return m

    def _decode(self, m):
        """The address in groups of three bits, so that a register's is found from three of them."""
        self._groups = []
        bits = self.bus.address
        used = bits_for(max((register.offset // 4 for register in self.map.registers), default=0))
        for low in range(0, used, 3):
            group = Signal(8, name=f"group{low // 3}")
            m.d.comb += group.eq(1 << bits[low : min(low + 3, used)])
            self._groups.append(group)
        if used < len(bits):
            m.d.comb += (beyond := Signal(name="beyond")).eq(bits[used:].any())
            self._groups.append(Cat(~beyond))

    def _hit(self, number):
        """Whether the bus has the address of this word."""
        digits = [number >> 3 * k & 7 for k in range(len(self._groups))]
        result = C(1)
        for group, digit in zip(self._groups, digits, strict=True):
            result &= group[digit]
        return result

    def _asked(self, m, name, hit):
        """A register that is set in the clock after a read with this address."""
        asked = Signal(name=f"{name}_asked")
        m.d.sync += asked.eq(hit & self.bus.read)
        return asked

    @staticmethod
    def _some(words):
        """Words in lists of those of which one is chosen in one clock."""
        return [words[k : k + _PART] for k in range(0, len(words), _PART)]

    @staticmethod
    def _kept(m, value):
        """A word a clock later."""
        part = Signal(32, name="part")
        m.d.sync += part.eq(value)
        return part

    @staticmethod
    def _late(m, asked, value):
        """The same a clock later, from registers that a memory can have as its own."""
        asked_later, register = Signal(name="asked_later"), Signal(32, name="late", reset_less=True)
        m.d.sync += [asked_later.eq(asked), register.eq(value)]
        return asked_later, register

    def _windows(self):
        """Item -> its windows."""
        kinds = {}
        for window in self.map.windows:
            kinds.setdefault(window.item, []).append(window)
        return kinds

    def _count(self, m):
        """The large counters, which share a memory, and what a read brings of them: a list of one or none."""
        if not self._counted:
            return []
        first = self._counted[0][0].offset // 4
        m.submodules.counters = counters = Counters(count=len(self._counted), width=32)
        hits = [self._hit(register.offset // 4) for register, _ in self._counted]
        events = [getattr(getattr(self, register.name), f"{field.name}_incr") for register, field in self._counted]
        m.d.comb += [
            counters.events.eq(Cat(events)),
            counters.clears.eq(Cat(hit & self.bus.write for hit in hits)),
            counters.read_number.eq(self.bus.address - first),
        ]
        asked = self._asked(m, "counters", _any(hits))
        return [(asked & ~counters.read_is_zero, counters.read_data)]

    def _pattern(self, window):
        """Word addresses of a window."""
        low, high = (window.stride // 4 - 1).bit_length(), (window.count - 1).bit_length()
        prefix = format(window.offset // 4, f"0{self.map.addr_width}b")[: self.map.addr_width - low - high]
        return prefix + "-" * (high + low)

    def _connect_windows(self, m):
        for window in self.map.windows:
            ports = getattr(self, window.name)
            m.d.comb += [
                ports.index.eq(self.bus.address >> (window.stride // 4 - 1).bit_length()),
                ports.select.eq(self.bus.address.matches(self._pattern(window))),
            ]

    @staticmethod
    def _word(values):
        """32 bits from ``{field: value}``."""
        parts, position = [], 0
        for field, value in sorted(values.items(), key=lambda item: item[0].low):
            parts += [C(0, field.low - position), value]
            position = field.low + field.width
        return Cat(*parts)

    def _item(self, item, register):
        """What the register of an item reads as."""
        ports = getattr(getattr(self.items, item), register.name, None)
        return self._word(
            {
                field: C(field.reset, field.width)
                if field.behaviour == Behaviour.CONSTANT
                else getattr(ports, field.name)
                for field in register.fields
            }
        )

    def _register(self, m, register, is_read, values):
        """Make a register, and return what it reads as."""
        written = Signal(name=f"{register.name}_written")
        m.d.comb += written.eq(self.bus.write & self._hit(register.offset // 4))
        ports = getattr(self, register.name, None)
        word = {}
        for field in register.fields:
            name = f"{register.name}_{field.name}"
            data = self.bus.write_data[field.low : field.low + field.width]
            match field.behaviour:
                case Behaviour.CONSTANT:
                    value = C(field.reset, field.width)
                case Behaviour.VALUE:
                    value = getattr(ports, field.name)
                case Behaviour.TAKEN:
                    value = getattr(ports, field.name)
                    m.d.comb += getattr(ports, f"{field.name}_read").eq(is_read)
                case Behaviour.COMMAND:
                    m.d.comb += [
                        getattr(ports, field.name).eq(data),
                        getattr(ports, f"{field.name}_written").eq(written),
                    ]
                    continue
                case Behaviour.PULSE:
                    m.d.comb += getattr(ports, field.name).eq(data & written)
                    continue
                case Behaviour.SETTING:
                    value = getattr(ports, field.name)
                    with m.If(written):
                        m.d.sync += value.eq(data)
                case Behaviour.FLAG:
                    value = Signal(init=field.reset, name=name)
                    m.d.sync += value.eq(value & ~(written & data) | getattr(ports, f"{field.name}_set"))
                case Behaviour.COUNTER if (register, field) in self._counted:
                    continue
                case Behaviour.COUNTER:
                    value = Signal(field.width, init=field.reset, name=name)
                    increment = getattr(ports, f"{field.name}_incr")
                    with m.If(written):
                        m.d.sync += value.eq(increment)
                    with m.Elif(~value.all()):
                        m.d.sync += value.eq(value + increment)
            word[field] = values[register.name, field.name] = value
        return self._word(word)


def sensor_bank(*, width, height):
    """The sensor's registers for a largest frame of ``width`` x ``height`` pixels."""
    return RegisterBank(registers=sensor_map(SensorConfig(width=width, height=height)), read_latency=READ_LATENCY)
