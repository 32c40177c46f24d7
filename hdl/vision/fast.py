"""FAST corners: the test of every pixel and its score, one pixel a clock.

Contract: every pixel (x, y) of a frame gives one position, in order, that tells about (x - 3, y - 3): whether
it is a corner, that is whether at least ``n`` contiguous pixels of its circle are all brighter than it by
more than ``threshold`` or all darker by more than that, and the longest such arc has at most ``max_arc``
pixels; its score, the largest threshold at which it is still a corner; that arc's length; and the polarity.
Within 3 pixels of the border there are no corners. The settings are taken in the clock of the pixel marked
``first`` and hold for its whole frame.

Algorithm: any arc of 9 or more holds both pixels of at least one of the circle's 8 opposite pairs and at
least one pixel of each, so if both of any pair are as bright as the centre or brighter, the arc is not a
darker one, and otherwise it is not a brighter one. So the signs choose the polarity without a threshold, and
one tree is enough. It works on e = max(0, d - 1) for brighter centres and max(0, d) for darker ones, where d
is how far a pixel of the circle lies on the chosen side: both come from one subtraction, without a carry for
the negation.

Windows of n pixels share most of their tree. With q odd, f = e[q], the pair P = min(e[q], e[q + 1]), the core
of eight e[q - 8 .. q - 1], for n > 10 of ten e[q - 10 .. q - 1], and x the pixel before the core, all 16 are
in

    score = max over q of min(core, n odd: max(x, f); n even: max(P, min(x, f)))

Beside the tree, the 16 bits d > threshold give the arc: the number of runs of 9 that begin somewhere is the
arc's length less 8.

::

    clock  1 circle - centre       4 fours, ends               7     windows
           2 polarity, e           5 eights, ends; runs of 9   8..10 maximum of 8, 4, 2; 10 corner
           3 pairs; d > threshold  6 cores; count of runs      11    position

Numbers: latency 14 clocks, of which :class:`hdl.vision.window.Window` has 3. At most one comparison and one
choice, or one subtraction, between two registers. No multiplier and no memory but the window's.

Model: :func:`sim.models.fast.fast` is bit-exact.
"""

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import GreyPixel, unstalled
from hdl.vision.window import Window, check_size

__all__ = ["Fast", "Position"]

_STAGES = 11


def _lesser(a, b):
    return Mux(a < b, a, b)


def _greater(a, b):
    return Mux(a > b, a, b)


def _longest_run(registers, bit):
    """Length less 9, and presence, of a run of 9 or more among 16 bits in a circle: stages 4 to 9.

    No two such runs fit, so the runs of 9 in it are contiguous: 1 to 7 of them, or 16 when all bits are set.
    Both fit in a count modulo 8.
    """
    threes = registers("threes", (bit[k] & bit[k - 15] & bit[k - 14] for k in range(16)), 1)
    nines = registers("nines", (threes[k] & threes[k - 13] & threes[k - 10] for k in range(16)), 1)
    fours = [nines[k : k + 4] for k in range(0, 16, 4)]
    counts = registers("counts_4", (_count(*four) for four in fours), 3)
    found = registers("found_4", (Cat(four).any() for four in fours), 1)
    counts = registers("counts_8", (counts[k] + counts[k + 1] for k in (0, 2)), 3)
    found = registers("found_8", [Cat(found).any()], 1)
    count = registers("count_16", [counts[0] + counts[1]], 3)[0]
    found = registers("found_16", found, 1)
    return registers("arc", [count - 1], 3)[0], registers("has_arc", found, 1)[0]


def _count(a, b, c, d):
    """How many of four bits are set, without an adder."""
    every = a & b & c & d
    return Cat(a ^ b ^ c ^ d, (a & b | c & d | (a | b) & (c | d)) & ~every, every)


def _score(registers, e, is_even, is_long):
    """The maximum over all windows of the minimum within: stages 3 to 10. Lists of 8 go by q = 1, 3 .. 15."""
    pairs = registers("pairs", (_lesser(e[q], e[(q + 1) % 16]) for q in range(1, 16, 2)))
    before = registers("before", (Mux(is_long, e[q - 11], e[q - 9]) for q in range(1, 16, 2)))
    after = registers("after", (e[q] for q in range(1, 16, 2)))

    fours = registers("fours", (_lesser(pairs[k], pairs[k - 7]) for k in range(8)))
    ends = registers("ends", (Mux((x > f) ^ is_even, x, f) for x, f in zip(before, after, strict=True)))
    pairs = registers("pairs_4", pairs)

    eights = registers("eights", (_lesser(fours[k - 4], fours[k - 2]) for k in range(8)))
    ends = registers("ends_5", (Mux(is_even & (p > end), p, end) for p, end in zip(pairs, ends, strict=True)))

    tens = zip(eights[-1:] + eights[:-1], eights, strict=True)
    cores = registers("cores", (Mux(is_long & (sooner < eight), sooner, eight) for sooner, eight in tens))
    ends = registers("ends_6", ends)
    best = registers("windows", map(_lesser, cores, ends))
    while len(best) > 1:
        best = registers(f"best_{len(best) // 2}", map(_greater, best[::2], best[1::2]))
    return best[0]


class Position(data.Struct):
    """What belongs to the pixel (x, y): the result for (x - 3, y - 3) and the marks of (x, y)."""

    arc: unsigned(3)  #: length of the longest arc, less 9
    score: unsigned(8)
    corner: unsigned(1)  #: when clear, so are ``score`` and ``arc``
    bright: unsigned(1)  #: the centre is brighter than the arc
    suppress: unsigned(1)  #: the setting of this frame
    scored: unsigned(1)  #: in a row that has centres, anywhere in it
    eol: unsigned(1)
    last: unsigned(1)
    cut: unsigned(1)  #: the frame before the one that begins here had no last pixel


class Settings(data.Struct):
    """The settings of a frame."""

    n: unsigned(4)
    threshold: unsigned(8)
    max_arc: unsigned(5)
    suppress: unsigned(1)


class Fast(wiring.Component):
    """Test and score of every pixel.

    Parameters
    ----------
    width : int
        Largest frame width in pixels, 1 to 4096.

    Raises
    ------
    TypeError, ValueError
        If ``width`` is no such number.

    Members
    -------
    i : :py:`In(unstalled(GreyPixel))`
        Frames, possibly cut short.
    n : :py:`In(4)`
        Least length of an arc, 9 to 12; what is below counts as 9, what is above as 12.
    threshold : :py:`In(8)`
        Least contrast, exclusive.
    max_arc : :py:`In(5)`
        Greatest length of the longest arc; from 16 on there is no limit.
    suppress : :py:`In(1)`
        Handed on with every position of the frame.
    o : :py:`Out(unstalled(Position))`
        One position for each pixel, 14 clocks after it.
    """

    i: In(unstalled(GreyPixel))
    n: In(4)
    threshold: In(8)
    max_arc: In(5)
    suppress: In(1)
    o: Out(unstalled(Position))

    def __init__(self, *, width):
        check_size(width=width)
        self._width = width
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        m.submodules.window = window = Window(width=self._width)
        connect(m, flipped(self.i), window.i)
        around = window.o.payload

        def registers(name, values, shape=8):
            """The next stage: one register for each value."""
            result = []
            for k, value in enumerate(values):
                register = Signal(shape, name=f"{name}_{k}", reset_less=True)
                m.d.sync += register.eq(value)
                result.append(register)
            return result

        # The marks of a pixel go along with it, from stage 0 (the window's output) to the last.
        marks = [Cat(around.inside, around.scored, around.first, around.eol, around.last, around.cut)]
        valid = [window.o.valid]
        for k in range(1, _STAGES + 1):
            marks.append(Signal(6, name=f"marks_{k}"))
            valid.append(Signal(name=f"valid_{k}"))
            m.d.sync += [marks[k].eq(marks[k - 1]), valid[k].eq(valid[k - 1])]
        inside, (_, scored, first, eol, last, cut) = marks[_STAGES - 2][0], marks[_STAGES]

        # Settings come into force when the frame's first pixel leaves the tree: by then no pixel of the frame
        # before is in it, and the first pixel that can be a corner comes at least 48 clocks after the frame's
        # first.
        taken, held = Signal(Settings), Signal(Settings)
        with m.If(self.i.valid & self.i.payload.first):
            m.d.sync += [
                taken.n.eq(Mux(self.n < 9, 9, Mux(self.n > 12, 12, self.n))),
                taken.threshold.eq(self.threshold),
                taken.max_arc.eq(self.max_arc),
                taken.suppress.eq(self.suppress),
            ]
        is_even, is_long = Signal(), Signal()
        with m.If(valid[_STAGES] & first):
            m.d.sync += [held.eq(taken), is_even.eq(~taken.n[0]), is_long.eq(taken.n > 10)]

        difference = registers("difference", (around.circle[k] - around.centre for k in range(16)), 9)
        is_darker = Cat(value[8] for value in difference)
        is_bright = Signal()
        m.d.comb += is_bright.eq((is_darker[:8] | is_darker[8:]).all())
        beyond = registers(
            "beyond", (Mux(value[8] == is_bright, value[:8] ^ is_bright.replicate(8), 0) for value in difference)
        )
        on_side = registers("on_side", (bit == is_bright for bit in is_darker), 1)
        bright = registers("bright_2", [is_bright], 1)[0]

        contrast = registers(
            "contrast",
            (
                side & (Cat(bright, value) >= Cat(1, held.threshold))
                for side, value in zip(on_side, beyond, strict=True)
            ),
            1,
        )
        arc_8, has_arc = _longest_run(registers, contrast)
        best = _score(registers, beyond, is_even, is_long)

        for k in range(3, _STAGES):
            bright = registers(f"bright_{k}", [bright], 1)[0]
        corner, arc = Signal(), Signal(3, reset_less=True)
        length = Signal(5)
        m.d.comb += length.eq(arc_8 + 9)
        m.d.sync += [
            corner.eq(inside & has_arc & (length >= held.n) & (length <= held.max_arc)),
            arc.eq(arc_8),
        ]

        o = self.o.payload
        m.d.comb += [
            self.o.valid.eq(valid[_STAGES]),
            o.suppress.eq(held.suppress),
            o.scored.eq(scored),
            o.eol.eq(eol),
            o.last.eq(last),
            o.cut.eq(cut),
        ]
        m.d.sync += [
            o.corner.eq(corner),
            o.bright.eq(bright),
            o.score.eq(Mux(corner, best - ~bright, 0)),
            o.arc.eq(Mux(corner, arc, 0)),
        ]
        return m
