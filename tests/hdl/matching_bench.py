"""Components given to matching directly, as segmentation would report them, and what must become of them."""

import functools

import numpy as np
from amaranth import Cat, Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.config import DIRECTIONS
from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import Support, blob_layout
from hdl.vision.matching.geometry import marker_layout
from hdl.vision.matching.matching import Matching
from hdl.vision.size_filter import SizeFilter
from sim.engine import StreamEngine, fields
from sim.models.matching import MARKER, find_markers
from sim.models.segmentation import BLOB

#: A beat of the bench carries this many bits of a component.
BITS = 60
_PART = data.StructLayout({"bits": BITS, "last": 1})


class ComponentBench(wiring.Component):
    """Components in parts; the size filter, which lets all of them through, and matching."""

    def __init__(self, width, height, depth=64):
        self._sizes, self._depth = {"width": width, "height": height}, depth
        super().__init__(
            {
                "i": In(unstalled(_PART)),
                **{name: In(16) for name in ("columns", "rows", "min_side")},
                "o": Out(unstalled(marker_layout(width, height))),
                "dropped": Out(1),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.size_filter = size_filter = SizeFilter(**self._sizes)
        m.submodules.matching = matching = Matching(**self._sizes, depth=self._depth)
        layout = blob_layout(**self._sizes)
        parts = -(-layout.size // BITS)
        gathered, complete = Signal(parts * BITS), Signal()
        with m.If(self.i.valid):
            m.d.sync += gathered.eq(Cat(gathered[BITS:], self.i.p.bits))
        m.d.sync += complete.eq(self.i.valid & self.i.p.last)
        connect(m, size_filter.o, matching.kept)
        connect(m, matching.o, flipped(self.o))
        for block in (size_filter, matching):
            m.d.comb += [block.i.p.as_value().eq(gathered), block.i.valid.eq(complete)]
        m.d.comb += [
            *(getattr(matching, name).eq(getattr(self, name)) for name in ("columns", "rows", "min_side")),
            self.dropped.eq(matching.dropped),
            self.overflow.eq(matching.overflow),
        ]
        return m


@functools.cache
def component_engine(size, depth=64):
    return StreamEngine(functools.partial(ComponentBench, depth=depth), *size)


def _encoded(direction, points, size):
    """Reach and other coordinate of pixels, as :class:`Support` says."""
    support = Support(direction, width=size[0], height=size[1])
    x, y = points[:, 0].astype(object), points[:, 1].astype(object)
    xs = x if direction[0] >= 0 else (1 << support.x_bits) - 1 - x
    ys = y if direction[1] >= 0 else (1 << support.y_bits) - 1 - y
    return abs(direction[0]) * xs + abs(direction[1]) * ys, y if direction[0] else x


def beats(blobs, size, kinds=None):
    """Beats of components; where ``kinds`` is no ITEM the beat is a mark."""
    layout = blob_layout(*size)
    value = np.zeros(len(blobs), object)

    def put(field, numbers):
        value[:] += (numbers & ((1 << field.width) - 1)) << field.offset

    put(layout["kind"], np.zeros(len(blobs), object) if kinds is None else np.array(kinds, object))
    for k, name in enumerate(("x_min", "y_min", "x_max", "y_max")):
        put(layout[name], blobs["box"][:, k].astype(object))
    for name in ("area", "gap_area", "gap_sum_x", "gap_sum_y", "euler"):
        put(layout[name], blobs[name].astype(object))
    extremes = layout["extremes"]
    for k, direction in enumerate(DIRECTIONS):
        field = extremes.shape[f"e{k}"]
        for name, numbers in zip(("reach", "other"), _encoded(direction, blobs["points"][:, k], size), strict=True):
            part = field.shape[name]
            value[:] += numbers << (extremes.offset + field.offset + part.offset)
    parts = -(-layout.size // BITS)
    table = [[int(v) >> BITS * k & ((1 << BITS) - 1) for k in range(parts)] for v in value]
    result = np.array(table, np.uint64)
    result[:, -1] |= np.uint64(1 << BITS)
    return result.ravel(), parts


def markers_of(run, size):
    """(kinds, markers) of what came out; a mark's marker means nothing."""
    found = fields(run["o"].payload, marker_layout(*size))
    markers = np.zeros(len(found), MARKER)
    for k in range(4):
        markers["vertices"][:, k] = np.stack([found[f"v{k + 1}.x"], found[f"v{k + 1}.y"]], axis=1)
    markers["box"] = np.stack([found[f"box_{end}.{axis}"] for end in ("min", "max") for axis in "xy"], axis=1)
    markers["area"], markers["gap_area"] = found["area"], found["gap_area"]
    return found["kind"], markers


def match_all(blobs, size, *, pause, min_side=4, depth=64):
    """(run, markers found, markers of the model) of components with ``pause`` clocks between them."""
    payloads, parts = beats(blobs, size)
    idle = np.zeros(len(payloads), np.int64)
    idle[::parts] = pause
    engine = component_engine(size, depth)
    engine.reset()
    settings = {"columns": size[0], "rows": size[1], "min_side": min_side}
    run = engine.run({"i": (payloads, idle)}, settings, drain_clocks=400 * depth)
    kinds, markers = markers_of(run, size)
    assert (kinds == ItemKind.ITEM.value).all()
    return run, markers, find_markers(blobs, *size, min_side)


def random_blobs(random, count, size):
    """Components near what a marker looks like, and near every limit: quadrilaterals with all kinds of holes."""
    blobs = np.zeros(count, BLOB)
    for blob in blobs:
        _fill(random, blob, size)
    return blobs


def _fill(random, blob, size):
    low, high = np.array([1, 1]), np.array(size) - 2
    centre = random.uniform(low + 6, high - 6)
    reach = random.uniform(3, max(4, min(*(centre - low), *(high - centre))))
    angles = random.uniform(0, 2 * np.pi) + np.arange(4) * np.pi / 2 + random.normal(0, random.choice([0, 0.1, 0.4]), 4)
    radii = reach * random.uniform(random.choice([0.3, 0.8, 0.97]), 1, 4)
    corners = centre + radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    cloud = np.clip(np.rint(corners), low, high).astype(int)
    if random.random() < 0.2:  # bulges
        more = centre + reach * random.uniform(0.6, 1.1) * np.stack(
            [np.cos(angles + random.uniform(0, 1)), np.sin(angles + random.uniform(0, 1))], axis=1
        )
        cloud = np.concatenate([cloud, np.clip(np.rint(more), low, high).astype(int)])
    points = np.array([cloud[np.argmax(cloud @ direction)] for direction in DIRECTIONS])
    blob["points"] = points
    blob["box"] = [*points.min(axis=0), *points.max(axis=0)]
    rolled = np.roll(points, -1, axis=0)
    area2 = int((points[:, 0] * rolled[:, 1] - points[:, 1] * rolled[:, 0]).sum())
    outline = int(np.abs(rolled - points).max(axis=1).sum())
    filled = max(2, (area2 + outline + 2) // 2 + int(random.normal(0, 1 + 0.06 * outline)))
    gap = max(1, round(filled * random.uniform(0.06, 0.127)))
    # The inner square's centre is 0.3 along the diagonal from a vertex, more or less.
    start = random.integers(4)
    share = random.choice([0.3, random.uniform(0.2, 0.4)])
    hole = cloud[start] + (cloud[(start + 2) % 4] - cloud[start]) * share
    hole = np.clip(hole + random.normal(0, 0.03 * reach, 2), blob["box"][:2], blob["box"][2:])
    blob["area"], blob["gap_area"] = filled - gap, gap
    blob["gap_sum_x"], blob["gap_sum_y"] = (hole * gap).astype(int)
    blob["euler"] = 0 if random.random() < 0.97 else int(random.integers(-1, 2))
