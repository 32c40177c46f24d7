"""Binary pixels in, one step per pixel out, each with its neighbours in this row and the row above.

A step needs the pixel to its right, so it is known when that pixel arrives, or one clock after the pixel itself at the
end of a row. The row above is one bit a column in a synchronous-read memory.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.pixels import BinaryPixel, unstalled

__all__ = ["Scan", "step_layout"]


def step_layout(width, height):
    """One step of the scan. At columns outside the frame, and above row 0, all is background.

    The events are those of 8-connectivity: of the runs that end at this column, in this row and in the row above, each
    has been compared with what is in the other row so far.
    """
    return data.StructLayout(
        {
            "x": bits_for(width - 1),
            "y": bits_for(height - 1),
            "run_start": bits_for(width - 1),  #: first column of the run that covers x, if any
            "ends_run": 1,  #: a run of this row ends here
            "ends_above": 1,  #: a run of the row above ends here
            "touch": 1,  #: a run ends here, and the runs of both rows that are here or begin next are neighbours
            "eol": 1,
            "last": 1,
        }
    )


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
    step : Out(step_layout(width, height))
    cut : Out(1)
        A new frame begins although the one before is not complete. Every state of the latter must be void from the
        next clock on; a step in this same clock still belongs to it.
    cut_row : Out(1)
        With ``cut``: the frame had got beyond row 0.
    """

    def __init__(self, *, width, height):
        self._width = width
        self._height = height
        super().__init__(
            {
                "i": In(unstalled(BinaryPixel)),
                "step_valid": Out(1),
                "step": Out(step_layout(width, height)),
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
        y = Signal(range(self._height))
        run_start = Signal(range(self._width))
        new_row = Signal()  # the pixel that arrives is the first of its row
        open_frame = Signal()
        step_valid = Signal()

        m.d.comb += step_valid.eq(held_valid & (held.eol | (self.i.valid & ~new.first)))
        m.d.sync += [
            self.step_valid.eq(step_valid),
            self.cut.eq(self.i.valid & new.first & open_frame),
            self.cut_row.eq(y != 0),
        ]
        # One bit wider than a column, because the memory is read two columns ahead.
        x_next = Signal(range(self._width + 1))
        m.d.comb += x_next.eq(Mux(self.i.valid, Mux(new_row | new.first, 0, x + 1), x))

        m.submodules.row = row = memory.Memory(shape=1, depth=self._width + 2, init=[])
        write = row.write_port()
        read = row.read_port()
        m.d.comb += [
            write.addr.eq(x),
            write.data.eq(held.foreground),
            write.en.eq(step_valid),
            read.addr.eq(x_next + 2),
        ]
        # In a row of three columns the pixel that is read is written in the same clock.
        bypass, bypass_bit, two_right = Signal(), Signal(), Signal()
        m.d.sync += [bypass.eq(step_valid & (write.addr == read.addr)), bypass_bit.eq(held.foreground)]
        m.d.comb += two_right.eq(Mux(bypass, bypass_bit, read.data))

        # The first two pixels of the row in hand, which the memory cannot deliver in time for the next row.
        head = [Signal(name=f"head{k}") for k in range(2)]
        head_now = [Mux(step_valid & (x == k), held.foreground, head[k]) for k in range(2)]
        above, above_right = Signal(), Signal()

        with m.If(step_valid):
            m.d.sync += [h.eq(now) for h, now in zip(head, head_now, strict=True)]
            m.d.sync += held_valid.eq(0)
        with m.If(self.i.valid):
            m.d.sync += [
                held.eq(new),
                held_valid.eq(1),
                x.eq(x_next),
                new_row.eq(new.eol),
                open_frame.eq(~new.last),
                above.eq(above_right),
                above_right.eq(two_right),
            ]
            with m.If(new_row | new.first | ~held.foreground):
                m.d.sync += run_start.eq(x_next)
            with m.If(new_row):
                m.d.sync += [y.eq(y + 1), above.eq(head_now[0]), above_right.eq(head_now[1])]
            with m.If(new.first):
                m.d.sync += y.eq(0)

        # The pixel of the step, its right neighbour, and what is above the two.
        here, right = held.foreground, new.foreground & ~held.eol
        up, up_right = above & (y != 0), above_right & (y != 0) & ~held.eol
        ends_run, ends_above = here & ~right, up & ~up_right
        m.d.sync += [
            self.step.x.eq(x),
            self.step.y.eq(y),
            self.step.run_start.eq(run_start),
            self.step.ends_run.eq(ends_run & step_valid),
            self.step.ends_above.eq(ends_above & step_valid),
            self.step.touch.eq((ends_above | ends_run) & (here | right) & (up | up_right) & step_valid),
            self.step.eol.eq(held.eol),
            self.step.last.eq(held.last),
        ]
        return m
