"""Binary pixels in, one step per pixel out: which runs end at it, in this row and in the row above, and which touch.

A step needs the pixel to its right, so it is known when that pixel arrives, or one clock after the pixel itself at the
end of a row. The row above is one bit a column in a synchronous-read memory.
"""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from hdl.memories import NO_COLLISIONS
from hdl.pixels import BinaryPixel, unstalled

__all__ = ["STEP", "Scan"]

#: One step of the scan. Its column and row are those of the steps counted. At columns outside the frame, and above row
#: 0, all is background. The events are those of 8-connectivity: of the runs that end at this column, in this row and in
#: the row above, each has been compared with what is in the other row so far.
STEP = data.StructLayout(
    {
        "foreground": 1,
        "ends_run": 1,  #: a run of this row ends here
        "ends_above": 1,  #: a run of the row above ends here
        "touch": 1,  #: a run ends here, and the runs of both rows that are here or begin next are neighbours
        "eol": 1,
        "last": 1,
    }
)

#: Columns of the row above that do not come from the memory, which in narrow rows is written too late for them.
_HEADS = 4


class Scan(wiring.Component):
    """Turns the stream of binary pixels into steps.

    Latency: a step comes one clock after the arrival of the next pixel; the last of a row comes two clocks after its
    pixel. One step a clock at most.

    Memory: ``width`` bits.

    Members
    -------
    i : In(unstalled(BinaryPixel))
    step_valid : Out(1)
        ``step`` holds a step in this clock.
    step : Out(STEP)
        Its events are clear in clocks without a step.
    cut : Out(1)
        A new frame begins although the one before is not complete. Every state of the latter must be void from the
        next clock on; a step in this same clock still belongs to it.
    cut_row : Out(1)
        With ``cut``: the frame had got beyond row 0.
    """

    def __init__(self, *, width):
        self._width = width
        super().__init__(
            {
                "i": In(unstalled(BinaryPixel)),
                "step_valid": Out(1),
                "step": Out(STEP),
                "cut": Out(1),
                "cut_row": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        new = self.i.p
        held = Signal(BinaryPixel)  # the pixel whose step is next
        held_valid = Signal()
        x = Signal(range(self._width))
        below_first = Signal()  # the row in hand is not row 0
        new_row = Signal()  # the pixel that arrives is the first of its row
        open_frame = Signal()
        step_valid = Signal()

        m.d.comb += step_valid.eq(held_valid & (held.eol | (self.i.valid & ~new.first)))
        m.d.sync += [
            self.step_valid.eq(step_valid),
            self.cut.eq(self.i.valid & new.first & open_frame),
            self.cut_row.eq(below_first),
        ]

        # It steps with the pixels: what it reads next comes after the pixels in ``above``, ``above_right``, ``coming``
        # and its output.
        ahead = Signal(range(self._width + _HEADS), init=_HEADS)
        m.submodules.row = row = memory.Memory(shape=1, depth=self._width + _HEADS, init=[], attrs=NO_COLLISIONS)
        write, read = row.write_port(), row.read_port()
        m.d.comb += [
            write.addr.eq(x),
            write.data.eq(held.foreground),
            write.en.eq(step_valid),
            read.addr.eq(ahead),
            read.en.eq(self.i.valid),
        ]
        heads = Signal(_HEADS)
        heads_now = Cat(Mux(step_valid & (x == k), held.foreground, heads[k]) for k in range(_HEADS))
        above, above_right, coming = Signal(), Signal(), Signal(reset_less=True)
        late_heads, from_heads = Signal(_HEADS - 2), Signal(_HEADS - 2)  # what comes after ``above_right``

        with m.If(step_valid):
            m.d.sync += [heads.eq(heads_now), held_valid.eq(0)]
        with m.If(self.i.valid):
            m.d.sync += [
                held.eq(new),
                held_valid.eq(1),
                x.eq(x + 1),
                ahead.eq(ahead + 1),
                new_row.eq(new.eol),
                open_frame.eq(~new.last),
                above.eq(above_right),
                above_right.eq(Mux(from_heads[0], late_heads[0], coming)),
                coming.eq(read.data),
                late_heads.eq(late_heads >> 1),
                from_heads.eq(from_heads >> 1),
            ]
            with m.If(new_row | new.first):
                m.d.sync += [x.eq(0), ahead.eq(_HEADS)]
            with m.If(new_row):
                m.d.sync += [
                    below_first.eq(1),
                    Cat(above, above_right, late_heads).eq(heads_now),
                    from_heads.eq(~0),
                ]
            with m.If(new.first):
                m.d.sync += below_first.eq(0)

        # The pixel of the step, its right neighbour, and what is above the two.
        here, right = held.foreground, new.foreground & ~held.eol
        up, up_right = above & below_first, above_right & below_first & ~held.eol
        ends_run, ends_above = here & ~right, up & ~up_right
        m.d.sync += [
            self.step.foreground.eq(here),
            self.step.ends_run.eq(ends_run & step_valid),
            self.step.ends_above.eq(ends_above & step_valid),
            self.step.touch.eq((ends_above | ends_run) & (here | right) & (up | up_right) & step_valid),
            self.step.eol.eq(held.eol),
            self.step.last.eq(held.last),
        ]
        return m
