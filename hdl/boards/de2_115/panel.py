"""Switches, keys, lights and digits of the DE2-115: what they set and show of the sensor, through the host port."""

from amaranth import Array, Cat, Const, Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.boards.de2_115.digits import digit
from hdl.boards.debounce import Debounce
from hdl.boards.decimal import Decimal
from hdl.boards.register_master import RegisterMaster
from hdl.regs.map import system_maps
from hdl.system.addresses import REGISTERS
from hdl.system.memory_bus import MemoryBus

__all__ = ["Panel"]

#: Counters of frames that were cut.
_CUTS = ("short_lines", "long_lines", "short_frames", "midline_starts")

#: Global_Gain of the camera, in 1/8: 1, 2, 4, and 8 as 4 with the multiplier.
_GAINS = (8, 16, 32, 32 | 64)


class Panel(wiring.Component):
    """See the table of :mod:`hdl.boards.de2_115.top`.

    Parameters
    ----------
    config : SensorConfig
        Of the sensor.
    second_clocks, bounce_clocks : int
        Clocks of a second, and of what a switch must last.

    Members
    -------
    key, switches : :py:`In(1)`, :py:`In(18)`
        May change at any time; ``key`` is high when it is pressed.
    host : :py:`Out(MemoryBus())`
    camera_done, camera_failed, lost, late, irq : :py:`In(1)`
    pixel_clock : :py:`In(1)`
        Changes now and then if the camera's clock runs.
    restart : :py:`Out(1)`
        A strobe: ``key`` was pressed.
    camera_values : :py:`Out(data.ArrayLayout(16, 2))`
        Exposure and gain.
    switches_taken : :py:`Out(18)`
    lights : :py:`Out(9)`
    digits : :py:`Out(data.ArrayLayout(7, 8))`
        Segments, active low.
    """

    def __init__(self, *, config, second_clocks, bounce_clocks):
        self._second = second_clocks
        offset, registers = system_maps(config)["sensor"]

        def address(name):
            return REGISTERS + offset + registers.register(name).offset

        self._enable, self._bright = (registers.register("control").field(name).low for name in ("enable", "bright"))
        self._automatic = registers.register("threshold").field("automatic").low
        self._master = RegisterMaster(
            writes=[address("threshold"), address("control")],
            reads=[address(name) for name in ("frame", "markers", *_CUTS)],
        )
        self._debounce = Debounce(width=19, clocks=bounce_clocks)
        super().__init__(
            {
                "key": In(1),
                "switches": In(18),
                "host": Out(MemoryBus()),
                "camera_done": In(1),
                "camera_failed": In(1),
                "lost": In(1),
                "late": In(1),
                "irq": In(1),
                "pixel_clock": In(1),
                "restart": Out(1),
                "camera_values": Out(data.ArrayLayout(16, 2)),
                "switches_taken": Out(18),
                "lights": Out(9),
                "digits": Out(data.ArrayLayout(7, 8)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.debounce = debounce = self._debounce
        m.submodules.master = master = self._master
        connect(m, master.bus, flipped(self.host))
        key, pressed, switches = Signal(), Signal(), self.switches_taken
        m.d.sync += pressed.eq(key)
        m.d.comb += [
            debounce.i.eq(Cat(self.switches, self.key)),
            Cat(switches, key).eq(debounce.o),
            self.restart.eq(key & ~pressed),
            master.values[0].eq(switches[:8] | (switches[:8] == 0) << self._automatic),
            master.values[1].eq(1 << self._enable | switches[8] << self._bright),
            self.camera_values[0].eq(Cat(Const(4, 3), switches[9:16])),  # Never 0.
            self.camera_values[1].eq(Array(_GAINS)[switches[16:18]]),
        ]
        frame, markers, *cuts = (master.words[k] for k in range(2 + len(_CUTS)))

        # Seconds: frames in the last one, a heartbeat, and whether the camera's clock changed.
        clocks, second_ends, heart = Signal(range(self._second)), Signal(), Signal()
        at_start, rate = Signal(8), Signal(8)
        clock_before, moved, runs = Signal(), Signal(), Signal()
        was_lost, was_late = Signal(), Signal()
        m.d.comb += second_ends.eq(clocks == self._second - 1)
        m.d.sync += [
            clocks.eq(clocks + 1),
            clock_before.eq(self.pixel_clock),
            moved.eq(moved | (self.pixel_clock ^ clock_before)),
            was_lost.eq(was_lost | self.lost),
            was_late.eq(was_late | self.late),
        ]
        with m.If(second_ends):
            m.d.sync += [clocks.eq(0), heart.eq(~heart), rate.eq(frame[:8] - at_start), at_start.eq(frame[:8])]
            m.d.sync += [runs.eq(moved), moved.eq(0)]
        m.d.comb += self.lights.eq(
            Cat(self.camera_done, self.camera_failed, was_lost, was_late, Const(0, 2), self.irq, heart, runs)
        )

        cut = Signal(16)
        m.d.sync += cut.eq(sum(count[:16] for count in cuts))
        shown = {"cut": (cut, 4), "markers": (markers[:8], 2), "rate": (rate, 2)}
        place = 0
        for name, (value, count) in shown.items():
            m.submodules[name] = decimal = Decimal(width=len(value), digits=count)
            m.d.comb += decimal.i.eq(value)
            for k in range(count):
                m.d.comb += self.digits[place + k].eq(digit(m, decimal.o[4 * k : 4 * k + 4]))
            place += count
        return m
