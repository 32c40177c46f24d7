"""Pixels from the camera's clock to the system's: a queue between two clocks that know nothing of each other.

Contract: what is given in domain ``pixel`` comes out in domain ``sync``, in order and once, as long as the queue has
room: the camera may be the faster one for a while, if its mean rate fits. A pixel that finds no room is lost, and with
it everything up to the next ``sof`` that finds room: so rows can never be joined that do not belong together, and the
framer behind sees a frame that another one cuts short. Each such loss is told once. Either clock may stop and
come back.

Resets: one of ``sync`` empties the queue. One of ``pixel`` loses everything up to the next ``sof``. Neither
has to wait for the other, or for a clock that stands still, because the write pointer is never reset, and the read
pointer is set to where the write pointer is.

::

    pixel  i ---> memory ------------------------------------> o  sync
             written -- gray -- 2 registers --> read up to it
           room up to <-- 2 registers -- gray -- taken

Numbers: one pixel a clock on both sides; a pixel comes out 3 to 4 clocks of ``sync`` after the clock in which it was
given. Memory: ``depth`` x 26 bits, one write port and one synchronous read port; up to 256 pixels are one M9K.

Timing: between the clocks go two Gray-coded pointers, whose bits must arrive within less than one clock of the sender
of each other, and the memory's words, which have rested for two clocks of ``sync`` when they are read.

Model: :func:`sim.models.crossing.frames_lost` says what may be missing.
"""

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl.pixels import CameraPixel, unstalled

__all__ = ["Crossing"]

#: Clocks after a reset of ``sync`` until what the other side had written is known here.
_FLUSH = 3


def _gray(binary):
    return binary ^ (binary >> 1)


def _binary(gray):
    return Cat(gray[bit:].xor() for bit in range(len(gray)))


class Crossing(wiring.Component):
    """Take pixels to another clock.

    Parameters
    ----------
    depth : int
        Pixels that can wait. A power of two, from 4 up.

    Raises
    ------
    ValueError
        If it is another number.

    Members
    -------
    i : :py:`In(unstalled(CameraPixel))`
        In domain ``pixel``.
    o : :py:`Out(unstalled(CameraPixel))`
        In domain ``sync``.
    lost : :py:`Out(1)`
        Pixels were lost: a strobe in domain ``sync`` for every frame to which that happened, unless the next one
        loses some within 3 of its clocks.
    """

    i: In(unstalled(CameraPixel))
    o: Out(unstalled(CameraPixel))
    lost: Out(1)

    def __init__(self, *, depth=256):
        if not isinstance(depth, int) or depth < 4 or depth & (depth - 1):
            raise ValueError(f"depth must be a power of two from 4 up, not {depth!r}")
        self._depth = depth
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        m.submodules.memory = memory = Memory(shape=CameraPixel, depth=self._depth, init=[])
        write, read = memory.write_port(domain="pixel"), memory.read_port(domain="sync")

        # Pointers have a bit more than the address: full and empty differ in it.
        bits = len(write.addr) + 1
        written, written_gray = Signal(bits, reset_less=True), Signal(bits, reset_less=True)
        taken, taken_gray = Signal(bits), Signal(bits)
        written_seen, taken_seen, has_loss, has_loss_seen = (
            Signal(bits),
            Signal(bits),
            Signal(reset_less=True),
            Signal(),
        )
        m.submodules.written = FFSynchronizer(written_gray, written_seen, o_domain="sync")
        m.submodules.taken = FFSynchronizer(taken_gray, taken_seen, o_domain="pixel")
        m.submodules.losses = FFSynchronizer(has_loss, has_loss_seen, o_domain="sync")
        self._write(m, self.i, write, written, written_gray, taken_seen, has_loss)

        flushing, available, next_taken = Signal(range(_FLUSH + 1), init=_FLUSH), Signal(), Signal(bits)
        with m.If(flushing != 0):
            m.d.sync += flushing.eq(flushing - 1)
            m.d.comb += next_taken.eq(_binary(written_seen))
        with m.Else():
            m.d.comb += [available.eq(taken_gray != written_seen), next_taken.eq(taken + available)]
        m.d.sync += [taken.eq(next_taken), taken_gray.eq(_gray(next_taken)), self.o.valid.eq(available)]
        m.d.comb += [read.addr.eq(taken), self.o.payload.eq(read.data)]

        had_loss = Signal(reset_less=True)
        m.d.sync += [had_loss.eq(has_loss_seen), self.lost.eq(has_loss_seen ^ had_loss)]
        return m

    @staticmethod
    def _write(m, i, port, written, written_gray, taken_gray, has_loss):
        """The side of the camera; ``has_loss`` changes with each loss."""
        is_full, taken, next_written = Signal(), Signal(), Signal(len(written))
        discards = Signal(init=1)  # everything until a frame begins
        m.d.comb += [
            # A whole round ahead: in Gray code the two highest bits differ then.
            is_full.eq(written_gray == taken_gray ^ (0b11 << len(written) - 2)),
            taken.eq(i.valid & ~is_full & (~discards | i.payload.sof)),
            next_written.eq(written + taken),
            port.addr.eq(written),
            port.data.eq(i.payload),
            port.en.eq(taken),
        ]
        m.d.pixel += [written.eq(next_written), written_gray.eq(_gray(next_written))]
        with m.If(taken):
            m.d.pixel += discards.eq(0)
        with m.Elif(i.valid & is_full & (~discards | i.payload.sof)):
            m.d.pixel += [discards.eq(1), has_loss.eq(~has_loss)]
        return m
