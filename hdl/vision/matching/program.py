"""The matcher's program: what every part does in every clock of a candidate.

There are no branches: a candidate that fails a test is given up, and all others take the same clocks. A row of the
program is one clock. What a point causes clocks later stands in the rows of these clocks, so nothing has to be carried
along with it; :class:`_Rows` puts it there, and a field that is wanted twice in a row is an error.

Names: A, B, C, D are the quadrilateral, f(P) = cross(C - A, P), g(P) = cross(D - B, P), and a = f(D) - f(B) is twice
its area. B0, D0 are B and D as they were first. 8 Hh + Hl is the hole's centre in eighths of a pixel.
"""

from hdl.vision.matching.geometry import POINTS
from hdl.vision.matching.lanes import Lane
from hdl.vision.matching.unfold import unfolding

__all__ = ["FIELDS", "INITIAL_POINTS", "IN_FLIGHT", "program"]

#: Points that are kept, after the extremes.
A, B, C, D, B0, D0, HH, HL, ZERO, ONE, OTHER = range(POINTS, POINTS + 11)

#: What they are at first. Zero and the last two never change: the larger of |x| and |y|, six times, is the sum of the
#: absolute products with (3, 3) and (-3, 3).
INITIAL_POINTS = [(0, 0)] * ONE + [(3, 3), (-3, 3)] + [(0, 0)] * (32 - OTHER - 1)

#: Rows from the last point of a search to a read of what was found, which is looked at a clock before the row.
FOUND = 7

#: Rows that are still carried out after the one that ends the program.
IN_FLIGHT = 3

#: Field -> bits; 0 where nothing is said, and :data:`Lane.NONE` of ``lane``.
FIELDS = {
    "lane": 5,
    **dict.fromkeys(("north", "weighs", "twice_y", "upside", "twice_x", "west"), 1),
    **{"number": 5, "from_low": 1, "from_high": 1, "turned": 1, "outside": 1, "put": 5},
    **dict.fromkeys(("put_x", "put_y", "line", "pair", "search", "first"), 1),
    **dict.fromkeys(("use_area", "subtract", "absolute", "flip", "less", "sum", "double", "anew"), 1),
    **dict.fromkeys(("reject_negative", "reject_positive", "note", "note_sign", "verdict", "report"), 1),
    **dict.fromkeys(("load_divisor", "load", "fresh", "step"), 1),
}


class _Rows:
    """Rows, and the row in which the next point is read."""

    def __init__(self):
        self.rows = {}
        self.now = 0
        self.readable = dict.fromkeys(range(32), 0)  # point -> first row in which it can be read

    def set(self, row, **fields):
        for name, value in fields.items():
            before = self.rows.setdefault(row, {}).setdefault(name, value)
            if before != value:
                raise ValueError(f"row {row}: {name} is wanted as {before} and as {value}")

    def wait(self, row):
        self.now = max(self.now, row)

    def _passes(self, *, line=False, pair=False, put=None, put_axes="xy", search=None):
        """What becomes of the point of the row in hand."""
        row, self.now = self.now, self.now + 1
        if line:
            self.set(row + 2, line=1, pair=int(pair))
        if put is not None:
            self.set(row + 2, put=put, **{f"put_{axis}": 1 for axis in put_axes})
            self.readable[put] = row + 3
        if search is not None:
            self.set(row + 5, search=1, first=int(search == "first"))
        return row

    def read(self, number, *, best=None, turned=False, **passes):
        if best is None and not turned and self.readable[number] > self.now:
            raise ValueError(f"row {self.now}: point {number} is not there yet")
        self.set(self.now, number=number, turned=int(turned))
        if best:
            self.set(self.now, **{f"from_{best}": 1})
        return self._passes(**passes)

    def take(self, **passes):
        """The point comes from outside, one row later."""
        self.set(self.now + 1, outside=1)
        return self._passes(**passes)

    def add(
        self,
        sign,
        number=None,
        *,
        anew=False,
        double=False,
        less=False,
        absolute=False,
        flip=False,
        best=None,
        **passes,
    ):
        """Add a point's product to the tally, or what the divisor is. Returns the row after the sum."""
        row = self.now
        if number is None:
            self.now += 1
        else:
            self.read(number, best=best, **passes)
        self.set(
            row + 5,
            use_area=int(number is None),
            subtract=int(sign < 0),
            less=int(less),
            absolute=int(absolute),
            flip=int(flip),
        )
        self.set(row + 6, sum=1, anew=int(anew), double=int(double))
        return row + 7

    def double(self, times=1):
        for _ in range(times):
            self.add(+1, ZERO, double=True)

    def line(self, start, end):
        self.read(start)
        self.read(end, line=True)

    def fetch(self, row, lane):
        """Field ``lane`` of the candidate is shown in the next row alone."""
        self.set(row - 2, lane=lane)
        return row + 1


def program(dividend_bits):
    """Rows, each a dict of fields."""
    rows = _Rows()
    rows.set(2, load=1, fresh=1)  # nothing of the candidate before is left
    x_known = _quadrilateral(rows, dividend_bits)
    _areas_of_triangles(rows)
    _hull(rows)
    _filling(rows, _hole_y(rows, dividend_bits, x_known))
    _offsets(rows)
    last = max(rows.rows) + IN_FLIGHT
    return [rows.rows.get(row, {}) for row in range(last + 1)]


def _quadrilateral(rows, dividend_bits):
    """Returns the row in which the x of the hole's centre is there, and done with.

    A and C are the opposite extremes farthest apart, B and D the farthest from AC; A, C from BD; B, D from AC."""
    order = [k + half for k in range(POINTS // 2) for half in (0, POINTS // 2)]
    for index, k in enumerate(order):
        row = rows.fetch(3 + index, k) - 1
        first, second = unfolding(k)
        rows.set(row + 3, **first)
        rows.set(row + 4, **second)
        rows.wait(row + 3)
        is_second = index % 2
        searched = None if not is_second else "first" if index == 1 else "next"
        rows.take(put=k, line=is_second, pair=is_second, search=searched)
    rows.wait(rows.now + FOUND)

    # Meanwhile, the x of the hole's centre, in two parts.
    start = 3 + POINTS
    rows.set(rows.fetch(start, Lane.GAP_AREA), load_divisor=1)
    x_known = _divide(rows, rows.fetch(start + 2, Lane.GAP_SUM_X), dividend_bits)

    rows.read(0, best="high", put=A)
    rows.read(POINTS // 2, best="high", put=C, line=True)
    x_known = _search(rows, x_known, None)
    rows.read(0, best="low", put=B0)
    rows.read(0, best="high", put=D0, line=True)
    x_known = _search(rows, x_known, HH)
    rows.read(0, best="high", put=A)
    rows.read(0, best="low", put=C, line=True)
    return _search(rows, x_known, HL)


def _search(rows, known, part):
    """The lowest and highest of all extremes. In the pause after them ``part`` of the hole's centre is kept."""
    for k in range(POINTS):
        rows.read(k, search="next" if k else "first")
    ready = rows.now + FOUND
    if part is not None:
        rows.wait(known - 1)
        if rows.now >= ready:
            raise ValueError("the hole's centre comes too late")
        row = rows.take(put=part, put_axes="x")
        known = _fraction(rows, row + 2)
    rows.wait(ready)
    return known


def _divide(rows, row, bits):
    """Divide what is shown in this row. Returns the row in which the quotient is there."""
    rows.set(row, load=1, fresh=1)
    for step in range(1, bits + 1):
        rows.set(row + step, step=1)
    return row + bits + 1


def _fraction(rows, row):
    """Three bits more. Returns the row in which they are there."""
    rows.set(row, load=1)
    for step in range(1, 4):
        rows.set(row + step, step=1)
    return row + 4


def _areas_of_triangles(rows):
    """a is above 0, and of each vertex: 8 times what it adds, minus 3 a, is 0 or more."""
    rows.add(+1, 0, best="high", put=D, anew=True)
    rows.set(rows.add(-1, 0, best="low", put=B, less=True), reject_negative=1)
    rows.wait(rows.now + 2)
    # 8 f(D) - 8 f(A) - 3 a and 8 f(A) - 8 f(B) - 3 a
    rows.add(-1, A, anew=True)
    rows.add(+1, D, double=True)
    rows.add(+1, B, double=True)
    rows.add(+1, D, double=True)
    rows.set(rows.add(+1, B), reject_negative=1)
    rows.add(+1, A, anew=True)
    rows.add(-1, B, double=True)
    rows.add(-1, D, double=True)
    rows.add(-1, B, double=True)
    rows.set(rows.add(-1, D), reject_negative=1)
    # 8 g0(B0) - 8 g0(C) - 3 a and 8 g0(A) - 8 g0(B0) - 3 a
    for nearer, farther in ((C, B0), (B0, A)):
        rows.line(B0, D0)
        rows.add(+1, farther, anew=True)
        rows.add(-1, nearer)
        rows.double()
        rows.line(A, C)
        _add_area(rows, -1, double=True)
        rows.set(_add_area(rows, -1, double=True), reject_negative=1)


def _add_area(rows, sign, *, double=False, less=False):
    """Add or subtract a, with the line AC; ``less``: and 1. Returns the row after the sum."""
    rows.add(sign, D, double=double, less=less and sign < 0)
    return rows.add(-sign, B, less=less and sign > 0)


def _hull(rows):
    """a - 8 (hull - a) is 0 or more."""
    rows.read(0)
    for k in range(1, POINTS + 1):
        rows.add(+1, k % POINTS, anew=k == 1, line=True)
    rows.line(A, C)
    _add_area(rows, +1)
    rows.double(2)
    rows.set(_add_area(rows, +1, double=True), reject_negative=1)


def _hole_y(rows, dividend_bits, x_known):
    """The y of the hole's centre. Returns the row in which its fraction is there."""
    shown = rows.fetch(x_known + 1, Lane.GAP_SUM_Y)
    rows.wait(_divide(rows, shown, dividend_bits) - 1)
    return _fraction(rows, rows.take(put=HH, put_axes="y") + 2)


def _filling(rows, fraction_known):
    """With F pixels filled and o on the outline: 8 F - 4 a - 3 o - 8 is 0 or more, and 16 F - 9 a - 9 o - 18 is not
    more than 0. Both are worked out twice as large."""
    gap = rows.now
    rows.add(+1, anew=True)
    rows.set(rows.fetch(gap + 5, Lane.AREA), load_divisor=1)
    rows.add(-1, ZERO, less=True)
    rows.add(+1)
    _add_area(rows, -1, double=True)
    rows.double(3)
    rows.wait(fraction_known - 1)
    rows.take(put=HL, put_axes="y")
    rows.set(_subtract_outline(rows), reject_negative=1)
    rows.line(A, C)
    rows.add(-1, ZERO, less=True)
    rows.add(-1, ZERO, less=True)
    rows.add(-1, D, double=True, less=True)
    rows.add(+1, B)
    _add_area(rows, -1)
    rows.set(_subtract_outline(rows), reject_positive=1)


def _subtract_outline(rows):
    """Subtract 6 o."""
    for start, end in ((A, B), (B, C), (C, D), (D, A)):
        rows.line(start, end)
        rows.add(-1, ONE, absolute=True)
        row = rows.add(-1, OTHER, absolute=True)
    return row


def _offsets(rows):
    """Of each diagonal: with X = 8 times how far the hole's centre is off it, times its length, 2 a - X is 0 or more;
    noted are the sign of the offset, and whether 4 X - 5 a and 3 a - 8 X are 0 or more. Then the verdict, V1 to V4."""
    for start, end in ((A, C), (B, D)):
        other = start != A
        rows.line(start, end)
        known = _add_offset(rows, +1, start)
        rows.set(known, note=1, note_sign=1)
        rows.wait(known + 1 - 5)
        _add_offset(rows, -1, start, flip=True)
        if other:
            rows.line(A, C)
        _add_area(rows, +1)
        rows.set(_add_area(rows, +1), reject_negative=1)
        _add_area(rows, -1, double=True)
        rows.set(_add_area(rows, -1, double=True, less=True), note=1)  # 5 a - 4 X - 1
        if other:
            rows.line(start, end)
        _add_offset(rows, -1, start, flip=True)
        rows.double()
        if other:
            rows.line(A, C)
        _add_area(rows, +1, double=True)
        row = _add_area(rows, +1, double=True)
        rows.set(row, note=1)
    rows.set(row + 1, verdict=1)
    rows.wait(row + 2)
    for vertex in (A, B, C, D):
        last = rows.read(vertex, turned=True)
    rows.set(rows.fetch(last + 1, Lane.RESULT), report=1)


def _add_offset(rows, sign, origin, *, flip=False):
    """Start the sum with the hole's offset from a line through ``origin``. Returns the row after it."""
    rows.add(sign, HH, anew=True, flip=flip)
    rows.add(-sign, origin, flip=flip)
    rows.double(2)
    return rows.add(sign, HL, double=True, flip=flip)
