"""The parts of matching, each alone against Python's integers: divider, search, extreme pixels and judge."""

import numpy as np
import pytest
from amaranth.sim import Simulator

from hdl.config import DIRECTIONS
from hdl.vision.blob import Support
from hdl.vision.matching.candidates import Candidates
from hdl.vision.matching.divider import Divider
from hdl.vision.matching.extremes import Extremes
from hdl.vision.matching.geometry import HOLE_FRACTION
from hdl.vision.matching.judge import Judge
from hdl.vision.matching.search import Rule, Search

SIZES = {"width": 640, "height": 480}
COORDINATE = (1 << 10 + HOLE_FRACTION) - 1
SEARCH_LATENCY = 5


def simulate(dut, testbench):
    simulator = Simulator(dut)
    simulator.add_clock(1e-6)
    simulator.add_testbench(testbench)
    simulator.run()


@pytest.mark.parametrize("dividend_bits, divisor_bits", [(30, 19), (8, 8), (5, 9)])
def test_divider(dividend_bits, divisor_bits):
    random = np.random.default_rng([1, dividend_bits])
    most, largest = (1 << dividend_bits) - 1, (1 << divisor_bits) - 1
    pairs = [(a, b) for a in (0, 1, most - 1, most) for b in (1, 2, largest - 1, largest)]
    pairs += [(int(random.integers(most + 1)), int(random.integers(1, largest + 1))) for _ in range(100)]
    pairs += [(int(random.integers(most + 1)), int(random.integers(1, 9))) for _ in range(20)]
    dut = Divider(dividend_bits=dividend_bits, divisor_bits=divisor_bits)

    async def testbench(ctx):
        for number, (dividend, divisor) in enumerate(pairs):
            ctx.set(dut.dividend, dividend)
            ctx.set(dut.divisor, divisor)
            ctx.set(dut.start, 1)
            await ctx.tick()
            ctx.set(dut.start, 0)
            ctx.set(dut.dividend, most - dividend)
            given_up = number % 5 == 4
            for _ in range(dividend_bits // 2 if given_up else dividend_bits):
                assert not ctx.get(dut.done)
                await ctx.tick()
            if not given_up:
                assert ctx.get(dut.done) and ctx.get(dut.quotient) == dividend // divisor, (dividend, divisor)

    simulate(dut, testbench)


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def minus(a, b):
    return a[0] - b[0], a[1] - b[1]


def searched(rule, line, origin, points):
    """[(result, point, point before)] of a stream of points."""
    before = dict(enumerate(points, 1))
    return [
        (
            {
                Rule.LINE: lambda k, p: cross(line, minus(p, origin)),
                Rule.PAIR: lambda k, p: sum(d * d for d in minus(p, before[k])),
                Rule.HULL: lambda k, p: cross(before[k], p),
                Rule.SIDE: lambda k, p: max(map(abs, minus(p, before[k]))),
            }[rule](k, point),
            point,
            before.get(k),
        )
        for k, point in enumerate(points)
        if rule == Rule.LINE or (k % 2 if rule == Rule.PAIR else k > 0)
    ]


@pytest.mark.parametrize("rule", Rule)
def test_search(rule):
    """Random and extreme points, in blocks and with pauses; few values, so that many results are equal."""
    random = np.random.default_rng([2, rule.value])
    dut = Search(**SIZES)

    def numbers(low, high, spread):
        values = random.integers(low, high + 1, 2) if spread else random.choice((low, high, 0, high // 2), 2)
        return tuple(map(int, values))

    async def testbench(ctx):
        ctx.set(dut.rule, rule)
        for number in range(150):
            spread = number % 3
            # Only what is measured from a line may have fraction bits.
            most = COORDINATE if rule == Rule.LINE else COORDINATE >> HOLE_FRACTION
            line, origin = numbers(-1023, 1023, spread), numbers(0, most, spread)
            # Nobody sums up what is measured from a line, and there is no room for it.
            count = 2 * int(random.integers(1, 9)) - (rule == Rule.LINE and number % 2)
            points = [numbers(0, most, spread) for _ in range(count)]
            for name, value in (("line", line), ("origin", origin)):
                ctx.set(getattr(dut, name), dict(zip("xy", value, strict=True)))
            for k, point in enumerate(points):
                ctx.set(dut.valid, 1)
                ctx.set(dut.first, k == 0)
                ctx.set(dut.point, dict(zip("xy", point, strict=True)))
                await ctx.tick()
                if random.random() < 0.1:
                    ctx.set(dut.valid, 0)
                    await ctx.tick()
            ctx.set(dut.valid, 0)
            await ctx.tick().repeat(SEARCH_LATENCY - 1)
            results = searched(rule, line, origin, points)
            low, high = (choose(results, key=lambda row: row[0]) for choose in (min, max))
            what = (rule, line, origin, points)
            assert (ctx.get(dut.low), ctx.get(dut.high)) == (low[0], high[0]), what
            if rule != Rule.LINE or len(points) == 1:
                assert ctx.get(dut.sum) == sum(row[0] for row in results), what
            for port, point in ((dut.low_point, low[1]), (dut.high_point, high[1])):
                assert (ctx.get(port.x), ctx.get(port.y)) == point, what
            if rule == Rule.PAIR:
                assert (ctx.get(dut.high_before.x), ctx.get(dut.high_before.y)) == high[2], what

    simulate(dut, testbench)


def encoded(direction, x, y):
    """A pixel as :class:`Support` says."""
    support = Support(direction, **SIZES)
    xs = x if direction[0] >= 0 else (1 << support.x_bits) - 1 - x
    ys = y if direction[1] >= 0 else (1 << support.y_bits) - 1 - y
    reach = abs(direction[0]) * xs + abs(direction[1]) * ys
    return {"reach": reach, "other": y if direction[0] else x}


def test_extremes():
    random = np.random.default_rng(3)
    dut = Extremes(**SIZES)

    async def testbench(ctx):
        for number in range(40):
            pixels = [tuple(map(int, random.integers(0, (640, 480)))) for _ in DIRECTIONS]
            if number < 4:
                pixels = [[(0, 0), (639, 479), (639, 0), (0, 479)][number]] * len(DIRECTIONS)
            coded = {f"e{k}": encoded(d, *pixels[k]) for k, d in enumerate(DIRECTIONS)}
            ctx.set(dut.extremes, coded)
            for k, pixel in enumerate(pixels):
                ctx.set(dut.index, k)
                await ctx.tick()
                assert (ctx.get(dut.point.x), ctx.get(dut.point.y)) == pixel, DIRECTIONS[k]

    simulate(dut, testbench)


def judged(area2, hull2, smallest2, filled2, outline, off_ac, off_bd):
    """(is a marker, turn) as the documentation of the matcher has it, in fractions of the area."""
    expected2 = area2 + outline + 2
    excess = filled2 - expected2
    shape = area2 > 0 and smallest2 / area2 >= 3 / 8 and (hull2 - area2) / area2 <= 1 / 8
    full = -outline / 4 <= excess <= expected2 / 8
    # Offsets are in eighths of pixels, areas twice areas.
    by_ac, by_bd = (
        area2 > 0 and abs(near) / 8 <= 3 / 64 * area2 and 5 / 32 * area2 <= abs(far) / 8 <= 1 / 4 * area2
        for near, far in ((off_ac, off_bd), (off_bd, off_ac))
    )
    if not (shape and full and (by_ac or by_bd)):
        return False, None
    return True, ((0 if off_bd > 0 else 2) if by_ac else (1 if off_ac < 0 else 3))


def test_judge():
    """Values on every limit and next to it."""
    random = np.random.default_rng(4)
    bits = Search(**SIZES).high.shape().width
    dut = Judge(bits=bits)
    seen = []

    async def testbench(ctx):
        for number in range(4000):
            area2, outline = int(random.integers(200, 300_000)), int(random.integers(10, 3000))
            if number % 7 == 0:
                area2 = int(random.choice([-area2, 0, 1, 8, 160]))
            expected2 = area2 + outline + 2
            near, far, hull, least, full, lack = random.integers(-1, 2, 6).tolist()
            near += int(random.choice([-3, 0, 3])) * area2 // 8
            far += int(random.choice([-8, -6, -5, 5, 6, 8])) * area2 // 4
            filled = [expected2 // 8 + full, 0, -(outline // 4) + lack, 0, 1][number % 5]
            values = {
                "area2": area2,
                "hull2": area2 + (area2 // 8 + hull if number % 5 == 0 else area2 // 20),
                "smallest2": (3 * area2 + 7) // 8 + least if number % 5 == 1 else 2 * area2 // 5,
                "filled2": expected2 + filled,
                "outline": outline,
                "off_ac": near if number % 2 else far,
                "off_bd": far if number % 2 else near,
            }
            for name, value in values.items():
                ctx.set(getattr(dut, name), value)
            await ctx.tick().repeat(3)
            expected = judged(**values)
            assert bool(ctx.get(dut.is_marker)) == expected[0], values
            if expected[0]:
                assert ctx.get(dut.turn) == expected[1], values
            seen.append(expected)

    simulate(dut, testbench)
    assert all(seen.count(verdict) > 300 for verdict in [(True, k) for k in range(4)] + [(False, None)])


@pytest.mark.parametrize("depth", [0, 2, 3])
def test_queue_too_small(depth):
    with pytest.raises(ValueError, match=f"depth must be 4 or more, not {depth}"):
        Candidates(**SIZES, depth=depth)
