"""Avalon-ST Video to a camera's pixels: packets are told apart, control packets read, lines counted.

Contract: the low four bits of a packet's first beat say what it is::

    0       video    its other beats are pixels, row by row
    15      control  its next three beats hold nine nibbles, the low halves of their symbols, least significant
                     symbol first: width, height (four each, most significant first) and interlacing
    others  user     ignored

Avalon-ST Video has no end of line, so lines are counted: the first pixel of a packet is marked ``sof``, each
``columns`` th and the last one ``eol``. ``columns`` is what the last control packet said when the video packet
began, or ``default_columns`` if there was none since the reset. Nothing else is made of a control packet: a video
packet of a wrong size, or one that belies its control packet, leaves as short or long lines or frames, which
:class:`~hdl.vision.framer.Framer` knows how to refuse and to count.

Wrong packets::

    control packet that ends before its fourth beat     has no effect                      SHORT CONTROL
    control packet that says interlaced                 video packets after it are fields
    video packet that is a field                        ignored                            INTERLACED
    startofpacket within a packet                       begins the next                    UNENDED
    beats after endofpacket, before startofpacket       ignored                            STRAY

A longer control packet is as good as one of four beats, and of several the last counts, also when it lacks its end.
A frame whose packet lacks its end is good if it is complete. A beat that shows two short control packets, one before it
and itself, counts as one.

``ready`` is low in a reset and in the clock after it, then high for ever: the sensor never stalls. ``valid`` counts
in clocks that follow one with ``ready``; that is what ``readyLatency`` 1 means.

Numbers: one beat a clock, latency 1 clock, all outputs are registers, no memory, no multiplier.

Model: :func:`sim.models.avalon_video_input.avalon_video_input` is bit-exact.
"""

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import data, enum, wiring
from amaranth.lib.wiring import In, Out

from hdl.ip.interfaces import AvalonVideo
from hdl.pixels import CameraPixel, unstalled

__all__ = ["AvalonVideoInput", "PacketError", "VideoSize"]

_VIDEO, _CONTROL = 0, 15


class PacketError(data.Struct):
    """What was wrong with a packet; see the table above."""

    short_control: unsigned(1)
    interlaced: unsigned(1)
    unended: unsigned(1)
    stray: unsigned(1)


class VideoSize(data.Struct):
    """What the last control packet said, as its nibbles follow one another."""

    interlacing: unsigned(4)  #: 0xxx: progressive
    height: unsigned(16)
    width: unsigned(16)


class _Packet(enum.Enum, shape=unsigned(2)):
    """What the packet in progress is."""

    NONE = 0
    VIDEO = 1
    CONTROL = 2
    IGNORED = 3


class AvalonVideoInput(wiring.Component):
    """Make a camera's pixels of Avalon-ST Video.

    Members
    -------
    video : :py:`In(AvalonVideo())`
    default_columns : :py:`In(16)`
        Pixels in a line while there was no control packet.
    size : :py:`Out(VideoSize)`
        What the last control packet said; zeros before there is one.
    known : :py:`Out(1)`
        There was a control packet.
    o : :py:`Out(unstalled(CameraPixel))`
    o_error : :py:`Out(PacketError)`
        One-clock strobes, in the clock in which the beat at fault would be at ``o``.
    """

    video: In(AvalonVideo())
    default_columns: In(16)
    size: Out(VideoSize)
    known: Out(1)
    o: Out(unstalled(CameraPixel))
    o_error: Out(PacketError)

    def elaborate(self, platform):
        m = Module()
        video = self.video
        was_ready, beat, starts, ends = Signal(), Signal(), Signal(), Signal()
        m.d.sync += [video.ready.eq(1), was_ready.eq(video.ready)]
        m.d.comb += [
            beat.eq(video.valid & was_ready),
            starts.eq(beat & video.startofpacket),
            ends.eq(beat & video.endofpacket),
        ]

        # Which packet a beat belongs to, and whether it is one of its payload.
        packet, payload = Signal(_Packet), Signal()
        kind, is_field = Signal(4), self.size.interlacing[3]
        m.d.comb += [
            kind.eq(video.data[:4]),
            payload.eq(beat & ~video.startofpacket),
        ]
        with m.If(ends):
            m.d.sync += packet.eq(_Packet.NONE)
        with m.Elif(starts):
            m.d.sync += packet.eq(_Packet.IGNORED)
            with m.If((kind == _VIDEO) & ~is_field):
                m.d.sync += packet.eq(_Packet.VIDEO)
            with m.Elif(kind == _CONTROL):
                m.d.sync += packet.eq(_Packet.CONTROL)

        # Control packets. The last of the three beats is taken as it comes.
        nibbles, beats_left = Signal(24), Signal(2)
        said, is_control, is_decoded = Signal(VideoSize), Signal(), Signal()
        m.d.comb += [
            said.as_value().eq(Cat(video.data[16:20], video.data[8:12], video.data[:4], nibbles)),
            is_control.eq(packet == _Packet.CONTROL),
            is_decoded.eq(payload & is_control & (beats_left == 1)),
        ]
        with m.If(starts):
            m.d.sync += beats_left.eq(3)
        with m.Elif(payload & (beats_left != 0)):
            m.d.sync += [beats_left.eq(beats_left - 1), nibbles.eq(said.as_value())]
        with m.If(is_decoded):
            m.d.sync += [self.size.eq(said), self.known.eq(1)]

        # Video packets. A line's length is taken when its packet starts.
        columns, last_column, columns_left = Signal(16), Signal(16), Signal(16)
        is_first, is_pixel, ends_line = Signal(), Signal(), Signal()
        m.d.comb += [
            columns.eq(Mux(self.known, self.size.width, self.default_columns) - 1),
            is_pixel.eq(payload & (packet == _Packet.VIDEO)),
            ends_line.eq(columns_left == 0),
        ]
        with m.If(starts):
            m.d.sync += [last_column.eq(columns), columns_left.eq(columns), is_first.eq(1)]
        with m.Elif(is_pixel):
            m.d.sync += [columns_left.eq(Mux(ends_line, last_column, columns_left - 1)), is_first.eq(0)]

        # A control packet that ends, in whatever way, while beats are left.
        is_short = Signal()
        m.d.comb += is_short.eq(
            (starts & is_control & (beats_left != 0))
            | (ends & ~video.startofpacket & is_control & (beats_left > 1))
            | (starts & ends & (kind == _CONTROL))
        )
        m.d.sync += [
            self.o.valid.eq(is_pixel),
            Cat(self.o.payload.b, self.o.payload.g, self.o.payload.r).eq(video.data),
            self.o.payload.sof.eq(is_first),
            self.o.payload.eol.eq(ends_line | video.endofpacket),
            self.o_error.short_control.eq(is_short),
            self.o_error.interlaced.eq(starts & (kind == _VIDEO) & is_field),
            self.o_error.unended.eq(starts & (packet != _Packet.NONE)),
            self.o_error.stray.eq(payload & (packet == _Packet.NONE)),
        ]
        return m
