"""The refiner's program: parts of rows, each row a step of the reckoner, some repeated.

The rows pass through a pipeline: a source is read before the step that loads it is taken, what is kept
in a place earlier still, and what a step causes is there clocks later. :class:`_Rows` lets rows pass until
what is needed is there. How often a row is repeated stands ``AHEAD`` rows before it.
"""

from amaranth.lib import enum

from hdl.vision.edges.shapes import DOWN, PART_BITS
from hdl.vision.refining.gather import PROBE
from hdl.vision.refining.reckoner import DIVISION
from hdl.vision.refining.shapes import FRACTION, SLOPE_FRACTION

__all__ = ["CONSTANTS", "FIELDS", "Part", "Place", "Source", "program"]

#: Rows before a repeated one that say so. They are not repeated.
AHEAD = 3
#: Rows from a source's place to the row that loads it; from a step that keeps to the place's row.
PLACE_READ, KEPT = 2, 3
#: Rows from the last step of a division to a load of its quotient.
QUOTIENT_READ = 4
#: Rows from one that sets c or s, or chooses the vertex, to a load of the vertex's distance.
FINE_READ = PROBE + 4
#: Rows that are still carried out after the one with ``end``.
IN_FLIGHT = 2


class Part(enum.IntEnum, shape=3):
    """Where the program can be entered."""

    CHORD = 0  #: the line through two whole-pixel vertices
    FIT = 1  #: a better line from the sums
    ENDS = 2  #: how far the line is from these vertices
    CROSS = 3  #: where a line across meets a line along
    ALIKE = 4  #: where two lines of a kind meet
    RESIDUAL = 5  #: mean square distance of all points


class Source(enum.IntEnum, shape=4):
    """What an operand is: groups of four of about the same width."""

    N = 0
    TOTAL = 1
    ALONG = 2
    ASIDE = 3
    U = 4
    E = 5
    QUOTIENT = 6
    FINE = 7
    UU = 8
    UE = 9
    EE = 10
    KEPT = 12  #: alone in its group of four


class Place(enum.IntEnum, shape=4):
    """What is kept, and where. Those of a line are there once for each side."""

    ORIGIN = 0
    ONE = 1
    C = 2
    DIVISOR = 3
    SLOPE = 4  #: of the side in hand
    START = 5  #: distance of its line from the vertex where it starts
    END = 6
    SLOPE_1 = 8  #: of the first of two lines, and its distance from their vertex
    OFFSET_1 = 9
    SLOPE_2 = 10
    OFFSET_2 = 11


#: Half a step of a point's part and half a step of a distance; crossings are counted this far across a side.
_HALF = 1 << (FRACTION - PART_BITS)
CONSTANTS = {Place.ORIGIN: (DOWN[1] << FRACTION) - _HALF, Place.ONE: 1 << 2 * SLOPE_FRACTION}

#: Field -> bits; 0 where nothing is said.
FIELDS = {
    **{"stay": 6, "source": 4, "place": 4},
    **dict.fromkeys(("load_b", "shift", "load_y", "clear", "add", "multiply", "divide", "minus", "absolute"), 1),
    **dict.fromkeys(("clear_sign", "keep", "set_c", "set_s", "at_end", "vertex_1", "vertex_2", "end"), 1),
}


class _Rows:
    def __init__(self, steps):
        self.rows = [{}]  # the first one is for the time when there is nothing to do
        self._steps = steps  #: of a multiplication
        self._repeatable = 0  # first row that can be repeated
        self._ready = {}  # name of a source or place -> first row that can read it
        self._settled = 0  # first row that can read the accumulator for another step

    def start(self):
        """A part starts. Returns its first row."""
        self._ready = {Source.FINE.name: len(self.rows) + FINE_READ}
        self._repeatable = len(self.rows) + AHEAD
        return len(self.rows)

    def end(self):
        self.step(end=1)
        for _ in range(IN_FLIGHT):
            self.step()

    def wait(self, row):
        while len(self.rows) < row:
            self.step()

    def step(self, repeat=0, **fields):
        if repeat:
            self.wait(self._repeatable)
            self.rows[-AHEAD]["stay"] = repeat
            self._repeatable = len(self.rows) + AHEAD + 1
        row = len(self.rows)
        self.rows.append({name: int(value) for name, value in fields.items()})
        if "keep" in fields:
            self._ready[fields["place"].name] = row + KEPT
        if any(fields.get(name) for name in ("set_c", "set_s", "at_end")):
            self._ready[Source.FINE.name] = row + FINE_READ
        if "divide" in fields:
            self._ready[Source.QUOTIENT.name] = row + QUOTIENT_READ
        if "add" in fields or "multiply" in fields:
            self._settled = row + 2

    def load(self, what, into="load_b"):
        """Load a source, or what is kept in a place."""
        self.wait(self._ready.get(what.name, 0))
        if isinstance(what, Place):
            self.step(place=what)
            for _ in range(PLACE_READ - 1):
                self.step()
            what = Source.KEPT
        self.step(source=what, **{into: 1})

    def absolute(self):
        self.wait(self._settled)
        self.step(absolute=1)

    def add(self, what, *, minus=False, shift=0):
        self.load(what)
        if shift:
            self.step(repeat=shift - 1, shift=1)
        self.step(add=1, minus=minus)

    def multiply(self, what, by=None, *, minus=False):
        if by is not None:
            self.load(by, into="load_y")
        self.load(what)
        self.step(repeat=self._steps - 2, multiply=1, minus=minus)
        self.step(multiply=1, minus=not minus)

    def divide(self, divisor, shift):
        """By ``divisor`` times 2^shift: the dividend loses its sign, the quotient has 16 more bits."""
        self.absolute()
        self.load(divisor)
        self.step(repeat=shift, shift=1)
        self.step(repeat=DIVISION - 1, divide=1)

    def fresh(self):
        self.step(clear=1, clear_sign=1)


def _chord(rows):
    rows.fresh()
    rows.add(Source.ALONG)
    rows.absolute()
    rows.step(keep=1, place=Place.DIVISOR)
    rows.step(clear=1)
    rows.add(Source.ASIDE)
    rows.divide(Place.DIVISOR, 0)
    rows.step(clear=1)
    rows.step(set_c=1)
    rows.add(Source.QUOTIENT)
    rows.step(set_s=1, keep=1, place=Place.SLOPE)
    rows.step(clear=1)
    rows.add(Source.FINE)
    rows.add(Place.ORIGIN)
    rows.step(set_c=1, keep=1, place=Place.C)


def _fit(rows):
    rows.fresh()
    rows.multiply(Source.UU, Source.N)
    rows.multiply(Source.U, Source.U, minus=True)
    rows.step(keep=1, place=Place.DIVISOR)
    rows.step(clear=1)
    rows.multiply(Source.UE, Source.N)
    rows.multiply(Source.E, Source.U, minus=True)
    rows.divide(Place.DIVISOR, PART_BITS)
    rows.step(clear=1)
    rows.add(Source.QUOTIENT)
    rows.add(Place.SLOPE)
    rows.step(set_s=1, keep=1, place=Place.SLOPE)
    rows.load(Source.QUOTIENT, into="load_y")
    rows.fresh()
    rows.add(Source.E, shift=SLOPE_FRACTION - PART_BITS)
    rows.multiply(Source.U, minus=True)
    rows.divide(Source.N, 2 * SLOPE_FRACTION - FRACTION)
    rows.step(clear=1)
    rows.add(Source.QUOTIENT)
    rows.add(Place.C)
    rows.step(set_c=1, keep=1, place=Place.C)


def _ends(rows):
    for place in (Place.START, Place.END):
        rows.step(clear=1, at_end=place == Place.END)
        rows.add(Source.FINE, minus=True)
        rows.add(Place.ORIGIN, minus=True)
        rows.step(keep=1, place=place)


def _cross(rows):
    rows.fresh()
    rows.add(Place.ONE)
    rows.multiply(Place.SLOPE_2, Place.SLOPE_1, minus=True)
    rows.absolute()
    rows.step(keep=1, place=Place.DIVISOR)
    rows.step(clear=1)
    rows.add(Place.OFFSET_1, shift=SLOPE_FRACTION)
    rows.multiply(Place.OFFSET_2, Place.SLOPE_1)
    rows.divide(Place.DIVISOR, 0)
    _vertex(rows, Place.OFFSET_2, Place.SLOPE_2)


def _alike(rows):
    rows.fresh()
    rows.add(Place.SLOPE_1)
    rows.add(Place.SLOPE_2, minus=True)
    rows.absolute()
    rows.step(keep=1, place=Place.DIVISOR)
    rows.step(clear=1)
    rows.add(Place.OFFSET_2)
    rows.add(Place.OFFSET_1, minus=True)
    rows.divide(Place.DIVISOR, 0)
    _vertex(rows, Place.OFFSET_1, Place.SLOPE_1)


def _vertex(rows, offset, slope):
    """The quotient is one coordinate; the other follows from a line."""
    rows.step(vertex_1=1, clear=1)
    rows.add(offset, shift=SLOPE_FRACTION)
    rows.multiply(slope, Source.QUOTIENT)
    rows.step(vertex_2=1)


def _residual(rows):
    rows.fresh()
    rows.add(Source.EE)
    rows.divide(Source.TOTAL, SLOPE_FRACTION)


def program(steps):
    """(rows, each a dict of fields; Part -> its first row). A product takes ``steps`` steps."""
    rows, starts = _Rows(steps), {}
    for part, write in zip(Part, (_chord, _fit, _ends, _cross, _alike, _residual), strict=True):
        starts[part] = rows.start()
        write(rows)
        rows.end()
    return rows.rows, starts
