"""The parts of matching, each alone against Python's integers, and the program that drives them."""

import numpy as np
import pytest
from amaranth.sim import Simulator

from hdl.config import DIRECTIONS
from hdl.pixels import ItemKind
from hdl.vision.blob import Support
from hdl.vision.matching.divider import Divider
from hdl.vision.matching.geometry import cross_shape
from hdl.vision.matching.matcher import program_of
from hdl.vision.matching.plane import Plane
from hdl.vision.matching.program import FIELDS, IN_FLIGHT, INITIAL_POINTS
from hdl.vision.matching.search import Search
from hdl.vision.matching.tally import Tally
from hdl.vision.matching.unfold import Unfold, unfolding
from hdl.vision.matching.waiting import VERDICT, Waiting

SIZES = {"width": 640, "height": 480}


def simulate(dut, testbench):
    simulator = Simulator(dut)
    simulator.add_clock(1e-6)
    simulator.add_testbench(testbench)
    simulator.run()


def set_all(ctx, dut, **values):
    for name, value in values.items():
        ctx.set(getattr(dut, name), value)


@pytest.mark.parametrize("dividend_bits, divisor_bits", [(27, 19), (8, 8), (5, 9)])
def test_divider(dividend_bits, divisor_bits):
    """Quotients, and three bits of their fractions."""
    random = np.random.default_rng([1, dividend_bits])
    most, largest = (1 << dividend_bits) - 1, (1 << divisor_bits) - 1
    pairs = [(a, b) for a in (0, 1, most - 1, most) for b in (1, 2, largest - 1, largest)]
    pairs += [(int(random.integers(most + 1)), int(random.integers(1, largest + 1))) for _ in range(40)]
    dut = Divider(dividend_bits=dividend_bits, divisor_bits=divisor_bits)

    async def testbench(ctx):
        for dividend, divisor in pairs:
            set_all(ctx, dut, load=1, fresh=1, load_divisor=1, dividend=dividend, divisor_in=divisor)
            await ctx.tick()
            set_all(ctx, dut, load=0, fresh=0, load_divisor=0, dividend=most - dividend, divisor_in=largest, step=1)
            await ctx.tick().repeat(dividend_bits)
            assert ctx.get(dut.quotient) == dividend // divisor, (dividend, divisor)
            set_all(ctx, dut, load=1, dividend=0, step=0)
            await ctx.tick()
            set_all(ctx, dut, load=0, step=1)
            await ctx.tick().repeat(3)
            assert ctx.get(dut.quotient) == (8 * dividend // divisor) % 8, (dividend, divisor)
            set_all(ctx, dut, step=0)

    simulate(dut, testbench)


def test_search():
    """Few values, so that many are equal, and the widest; with pauses."""
    random = np.random.default_rng(2)
    shape = cross_shape(**SIZES)
    dut = Search(shape=shape)
    limit = 1 << shape.width - 1

    async def testbench(ctx):
        for number in range(200):
            choices = [(-limit, limit - 1), (-1, 0, 1), tuple(random.integers(-limit, limit, 9).tolist())][number % 3]
            values = random.choice(choices, int(random.integers(1, 17))).tolist()
            for k, value in enumerate(values):
                set_all(ctx, dut, valid=1, first=k == 0, value=value)
                await ctx.tick()
                if random.random() < 0.2:
                    set_all(ctx, dut, valid=0, first=1, value=limit - 1)
                    await ctx.tick()
            set_all(ctx, dut, valid=0)
            await ctx.tick()
            assert (ctx.get(dut.low), ctx.get(dut.high)) == (values.index(min(values)), values.index(max(values)))

    simulate(dut, testbench)


def encoded(direction, x, y):
    """A pixel as :class:`Support` says, in the order of lanes."""
    support = Support(direction, **SIZES)
    xs = x if direction[0] >= 0 else (1 << support.x_bits) - 1 - x
    ys = y if direction[1] >= 0 else (1 << support.y_bits) - 1 - y
    if not direction[0]:
        return {"reach": x, "other": ys}
    return {"reach": abs(direction[0]) * xs + abs(direction[1]) * ys, "other": y}


def test_unfold():
    random = np.random.default_rng(3)
    dut = Unfold(**SIZES)
    names = {name: 0 for part in unfolding(0) for name in part}

    async def testbench(ctx):
        for number in range(30):
            for k, direction in enumerate(DIRECTIONS):
                pixel = tuple(map(int, random.integers(0, (640, 480))))
                if number < 4:
                    pixel = [(0, 0), (639, 479), (639, 0), (0, 479)][number]
                first, second = unfolding(k)
                set_all(ctx, dut, word=encoded(direction, *pixel), **names | first)
                await ctx.tick()
                set_all(ctx, dut, word={"reach": 0, "other": 0}, **names | second)
                assert (ctx.get(dut.point.x), ctx.get(dut.point.y)) == pixel, direction
                await ctx.tick()
                set_all(ctx, dut, **names)
                assert (ctx.get(dut.point.x), ctx.get(dut.point.y)) == (0, 0)

    simulate(dut, testbench)


def test_plane():
    """Points from outside and from memory; lines, hulls, pairs, and the directions that never change."""
    random = np.random.default_rng(4)
    dut = Plane(**SIZES, initial=INITIAL_POINTS)
    count = 600
    kept, rows, expected = dict(enumerate(INITIAL_POINTS)), [{} for _ in range(count + 6)], {}
    line, before, written = None, None, []
    for row in range(3, count):
        while written and written[0][0] <= row:
            _, place, value = written.pop(0)
            kept[place] = value
        outside = row < 20 or random.random() < 0.3
        number = int(random.integers(len(INITIAL_POINTS)))
        given = tuple(map(int, random.integers(0, (640, 480))))
        point = given if outside else kept[number]
        rows[row] |= {"number": number}
        rows[row + 1] |= {"outside": int(outside), "given": dict(zip("xy", given, strict=True))}
        is_pixel = point[0] >= 0
        loads = bool(before) and is_pixel and random.random() < 0.4
        pair = loads and random.random() < 0.4
        rows[row + 2] |= {"line": int(loads), "pair": int(pair)}
        if loads:
            line = (point[0] - before[0], point[1] - before[1])
        if line is not None:
            cross = line[0] * point[1] - line[1] * point[0]
            expected[row + 5] = line[0] ** 2 + line[1] ** 2 if pair else cross
        # After a pair the point before is not at hand.
        before = point if is_pixel and not pair else None
        if is_pixel and random.random() < 0.3:
            place = int(random.integers(10))
            written.append((row + 3, place, point))
            rows[row + 2] |= {"put": place, "put_x": 1, "put_y": 1}
    quiet = {"number": 0, "outside": 0, "put_x": 0, "put_y": 0, "line": 0, "pair": 0}

    async def testbench(ctx):
        for row, fields in enumerate(rows):
            set_all(ctx, dut, **quiet | fields)
            if row in expected:
                assert ctx.get(dut.product) == expected[row], row
            await ctx.tick()

    simulate(dut, testbench)
    assert len(expected) > 500


def test_tally():
    """Sums of products and areas with whole factors, for their signs; next to 0 as well."""
    random = np.random.default_rng(5)
    dut = Tally(product=cross_shape(**SIZES), area=19, total=26)
    names = ("use_area", "subtract", "absolute", "flip", "less", "valid", "double", "clear")
    rows, signs, total = [], {}, 0
    for number in range(3000):
        product, area = int(random.integers(-(10**5), 10**5)), int(random.integers(10**5))
        use_area, subtract, flip, less, double = (int(random.random() < 0.3) for _ in range(5))
        absolute = int(not use_area and random.random() < 0.3)
        anew = number == 0 or random.random() < 0.1 or abs(total) > 10**7
        if number % 3 == 0 and not absolute:
            product = max(min(random.choice([-1, 1]) * total, 10**6), -(10**6))  # to get near 0
        value = area if use_area else abs(product) if absolute else product
        minus = subtract ^ flip ^ (absolute and product < 0)  # what the adder does decides what less does
        total = (0 if anew else 2 * total if double else total) + (-value if subtract ^ flip else value)
        total += less * (-1 if minus else 1)
        rows.append({"product": int(product), "area": area, "use_area": use_area, "subtract": subtract,
                     "absolute": absolute, "flip": flip, "less": less})  # fmt: skip
        signs[number + 2] = total < 0
        rows[-1] |= {"second": {"valid": 1, "double": double, "clear": int(anew)}}

    async def testbench(ctx):
        for number in range(len(rows) + 2):
            row = dict(rows[number]) if number < len(rows) else {}
            row.pop("second", None)
            second = rows[number - 1]["second"] if 0 < number <= len(rows) else {}
            set_all(ctx, dut, **dict.fromkeys(names, 0) | row | second)
            if number in signs:
                assert ctx.get(dut.negative) == signs[number], number
            await ctx.tick()

    simulate(dut, testbench)
    assert 500 < sum(signs.values()) < 2500


@pytest.mark.parametrize("width, height", [(16, 16), (640, 480), (1920, 1080), (4096, 4096)])
def test_program(width, height):
    """Fields fit, and 14 candidates that end in one row of 640 pixels are worked off within 7 rows."""
    rows = program_of(width, height)
    assert all(0 <= value < 1 << FIELDS[name] for row in rows for name, value in row.items())
    assert 14 * (len(rows) + 6) < 7 * 640
    assert rows[0] == {} and rows[-IN_FLIGHT:] == [{}] * IN_FLIGHT
    assert [row.get("report", 0) for row in rows[:-IN_FLIGHT]] == [0] * (len(rows) - IN_FLIGHT - 1) + [1]


@pytest.mark.parametrize("depth", [4, 64])
def test_waiting(depth):
    """Components in every clock: no place is given twice, candidates and marks leave in order, none without a count."""
    random = np.random.default_rng([6, depth])
    dut = Waiting(depth=depth)
    seen = {"dropped": 0, "left": 0}

    async def testbench(ctx):
        verdicts, taken, queue, voids = [None] * VERDICT, set(), [], False
        for clock in range(4200):
            busy = random.random() < (0.9 if clock % 1000 < 500 else 0.2)
            comes = (
                [ItemKind.ITEM, ItemKind.END, ItemKind.ABORT][random.choice(3, p=[0.985, 0.01, 0.005])]
                if busy
                else None
            )
            place = ctx.get(dut.slot)
            due = verdicts.pop(0)
            wanted = (
                due is not None and due[0] == ItemKind.ITEM and random.random() < (0.5 if clock % 700 < 120 else 0.03)
            )
            rejected = due is not None and due[0] == ItemKind.ITEM and not wanted
            mark = due[0] if due else ItemKind.ITEM
            take = clock % 9 == 0 and ctx.get(dut.valid)
            set_all(ctx, dut, component=comes == ItemKind.ITEM, wanted=wanted, rejected=rejected, mark=mark, take=take)
            if comes == ItemKind.ITEM:
                assert place and place not in taken, clock
                taken.add(place)
            verdicts.append(None if comes is None else (comes, place))
            waiting = sum(kind == ItemKind.ITEM for kind, _ in queue)
            lost = wanted and waiting == depth // 2
            assert ctx.get(dut.dropped) == lost and not ctx.get(dut.overflow), clock
            seen["dropped"] += lost
            if take:
                kind, where = queue[0]
                assert ctx.get(dut.kind) == kind and (kind != ItemKind.ITEM or ctx.get(dut.place) == where), clock
                if ctx.get(dut.taken):
                    queue.pop(0)
                    taken.discard(where) if kind == ItemKind.ITEM else None
                    seen["left"] += 1
            if due and (rejected or lost):
                taken.discard(due[1])
            if wanted and not lost:
                queue.append(due)
                voids = True
            elif mark == ItemKind.END or (mark == ItemKind.ABORT and voids):
                queue.append(due)
                voids = False
            await ctx.tick()

    simulate(dut, testbench)
    assert seen["dropped"] > 20 and seen["left"] > 70


@pytest.mark.parametrize("depth", [0, 2, 6])
def test_wrong_depth(depth):
    with pytest.raises(ValueError, match=f"depth must be a power of two from 4 up, not {depth}"):
        Waiting(depth=depth)
