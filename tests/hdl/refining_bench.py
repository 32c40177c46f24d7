"""Grey pixels in, refined markers out, and what must become of them."""

import functools

import numpy as np
from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import GreyPixel, ItemKind, unstalled
from hdl.vision.matching.matching import Matching
from hdl.vision.refining.refining import Refining
from hdl.vision.refining.shapes import FLAGS, refined_layout
from hdl.vision.segmentation.segmentation import Segmentation
from hdl.vision.size_filter import SizeFilter
from hdl.vision.threshold import Threshold
from sim.engine import StreamEngine, fields
from sim.models.edges import edge_points
from sim.models.grey import grey
from sim.models.matching import find_markers
from sim.models.refine import REFINEMENT, Quality, refine_markers
from sim.models.segmentation import find_blobs
from sim.models.threshold import threshold
from sim.scene import random_marker_scene, render

ITEM = ItemKind.ITEM.value
#: Clocks in which all that wait are worked off.
DRAIN = 40_000


class Chain(wiring.Component):
    """From grey pixels to refined markers."""

    def __init__(self, width, height, **depths):
        self._sizes, self._depths = {"width": width, "height": height}, depths
        super().__init__(
            {
                "i": In(unstalled(GreyPixel)),
                **{name: In(16) for name in ("columns", "rows")},
                **{name: In(8) for name in ("threshold", "contrast")},
                "bright": In(1),
                "o": Out(unstalled(refined_layout(width, height))),
                "dropped": Out(1),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.threshold = level = Threshold()
        m.submodules.segmentation = segmentation = Segmentation(**self._sizes)
        m.submodules.size_filter = size_filter = SizeFilter(**self._sizes)
        m.submodules.matching = matching = Matching(**self._sizes, depth=64)
        m.submodules.refining = refining = Refining(**self._sizes, **self._depths)
        connect(m, flipped(self.i), level.i)
        connect(m, level.o, segmentation.i)
        connect(m, segmentation.o, size_filter.i)
        connect(m, size_filter.o, matching.kept)
        connect(m, matching.o, refining.i)
        connect(m, refining.o, flipped(self.o))
        m.d.comb += [
            level.level.eq(self.threshold),
            level.bright.eq(self.bright),
            matching.i.payload.eq(segmentation.o.payload),
            matching.i.valid.eq(segmentation.o.valid),
            matching.min_side.eq(12),
            refining.pixels.payload.eq(self.i.payload),
            refining.pixels.valid.eq(self.i.valid),
            *(getattr(block, name).eq(getattr(self, name))
              for block in (matching, refining) for name in ("columns", "rows")),
            *(getattr(refining, name).eq(getattr(self, name)) for name in ("threshold", "contrast", "bright")),
            self.dropped.eq(refining.dropped),
            self.overflow.eq(matching.overflow | refining.overflow),
        ]  # fmt: skip
        return m


@functools.cache
def chain(size, **depths):
    return StreamEngine(functools.partial(Chain, **depths), *size)


def settings(size, *, level=120, contrast=16, bright=False):
    return {"columns": size[0], "rows": size[1], "threshold": level, "contrast": contrast, "bright": int(bright)}


def picture(seed, size, count=1, *, invert=False, **scene):
    """Grey levels of a random scene."""
    image = render(random_marker_scene(seed, *size, count=count, **scene)).image
    image = 255 - image if invert else image
    return grey(np.repeat(image[..., None], 3, axis=2))


def expected(frame, *, level=120, contrast=16, bright=False):
    """(markers, refinements) of the models."""
    rows, columns = frame.shape
    markers = find_markers(find_blobs(threshold(frame, level, bright)), columns, rows, 12)
    points = edge_points(frame, level, bright, contrast)
    bits = (max(frame.shape) - 1).bit_length()
    refined = refine_markers(markers, *points, columns, rows, bits)
    result = np.zeros(len(refined), REFINEMENT)
    for name in REFINEMENT.names:
        result[name] = refined[name]
    return markers, result


def refinements(run, size):
    """(kinds, vertices, refinements, clocks) of all that came out."""
    found = fields(run["o"].payload, refined_layout(*size))
    result = np.zeros(len(found), REFINEMENT)
    whole = np.zeros((len(found), 4, 2), int)
    for k in range(4):
        for axis, name in enumerate("xy"):
            whole[:, k, axis] = found[f"v{k + 1}.{name}"]
            result["offsets"][:, k, axis] = found[f"offset{k + 1}.{name}"]
    result["residual"], result["points"] = found["quality.residual"], found["quality.points"]
    for bit, name in enumerate(FLAGS):
        result["flags"] |= found[f"quality.{name}"].astype(np.int32) << bit
    return found["kind"], whole, result, run["o"].clock


def frames_of(run, size, since=-1):
    """[(mark, vertices, refinements)] of each frame that came out after clock ``since``."""
    kinds, whole, result, clocks = refinements(run, size)
    kinds, whole, result = (found[clocks > since] for found in (kinds, whole, result))
    ends = np.flatnonzero(kinds != ITEM)
    assert not len(kinds) or ends[-1] == len(kinds) - 1, "something came after the last frame"
    starts = [0, *(ends[:-1] + 1)]
    return [(int(kinds[end]), whole[start:end], result[start:end]) for start, end in zip(starts, ends, strict=True)]


def check(got, frames, note="", *, may_lose=0, **config):
    """Complete frames are as the models have them. Returns how many markers were refined.

    Frames so small follow each other too fast for the refiner at times: up to ``may_lose`` markers may say so.
    """
    assert [kind for kind, *_ in got] == [ItemKind.END.value] * len(frames), note
    refined = lost = 0
    for number, ((_, whole, result), frame) in enumerate(zip(got, frames, strict=True)):
        markers, model = expected(frame, **config)
        assert np.array_equal(whole, markers["vertices"]), f"{note}: frame {number}: markers"
        for one, other in zip(result, model, strict=True):
            if lost < may_lose and one["flags"] & Quality.LOST:
                assert not one["flags"] & Quality.REFINED and not one["offsets"].any()
                lost += 1
            else:
                assert one == other, f"{note}: frame {number}: {one} instead of {other}"
                refined += bool(one["flags"] & Quality.REFINED)
    return refined
