"""What matching needs of components, written at once and read word by word."""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, enum, memory, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.config import DIRECTIONS
from hdl.memories import NO_COLLISIONS_IN_BLOCK
from hdl.vision.blob import blob_layout, sum_bits
from hdl.vision.matching.geometry import POINTS, pixel_layout

__all__ = ["Lane", "LaneReading", "Lanes", "word_layout"]


class Lane(enum.IntEnum, shape=5):
    """What is read: one of the extremes 0 to 15, or one of these."""

    GAP_AREA = 16
    AREA = 17
    GAP_SUM_X = 18
    GAP_SUM_Y = 19
    RESULT = 20  #: all that a marker's report shows of its component, and the areas
    NONE = 31


def word_layout(width, height):
    """An extreme pixel, with room for the widest. ``reach`` is x and ``other`` is y's reach where a direction is
    upright."""
    extremes = blob_layout(width, height)["extremes"].shape
    shapes = [extremes[f"e{k}"].shape for k in range(POINTS)]
    return data.StructLayout({name: max(shape[name].width for shape in shapes) for name in ("reach", "other")})


class LaneReading(wiring.Signature):
    """How a component is read, from the reader's side.

    Members
    -------
    place : Out
        The word of the component.
    lane : Out(Lane)
        What is read.
    word : In(word_layout(width, height))
    area : In
        Area or area of the gaps.
    gap_sum : In
        Sum of the gaps' x or y.
    box_min, box_max : In(pixel_layout(width, height)), result_area, result_gap_area : In
    """

    def __init__(self, *, width, height, slots):
        area, *sums = sum_bits(width, height)
        pixel = pixel_layout(width, height)
        super().__init__(
            {
                "place": Out(bits_for(slots)),
                "lane": Out(5),
                "word": In(word_layout(width, height)),
                "area": In(area),
                "gap_sum": In(max(sums)),
                "box_min": In(pixel),
                "box_max": In(pixel),
                "result_area": In(area),
                "result_gap_area": In(area),
            }
        )


def _or(values):
    result = values[0]
    for value in values[1:]:
        result |= value
    return result


class Lanes(wiring.Component):
    """A memory for each field, all written with a component.

    Instead of choosing one of them, their outputs are joined by OR, and word 0 of every memory is zero: that is what is
    read of all fields that are not asked for. So each memory has an address of its own, with a short way.

    ::

        lane -> 20 addresses -> | | -> 20 memories -> | | -> | | -> OR of 4 -> | | -> OR -> | | -> word
                                                                 -> OR of 2 -> areas, sums

    Throughput: a component a clock; a word a clock. Latency: from ``lane`` to areas, sums and result 3 clocks, to
    ``word`` 5.

    Memory: the fields of ``slots`` components and a zero.

    Members
    -------
    write : In(1), component : In(blob_layout(width, height)), slot : In
        A component goes to word ``slot``, from 1 on.
    reader : In(LaneReading(width, height, slots))
    """

    def __init__(self, *, width, height, slots):
        self._sizes = {"width": width, "height": height}
        self._slots = slots
        super().__init__(
            {
                "write": In(1),
                "component": In(blob_layout(width, height)),
                "slot": In(bits_for(slots)),
                "reader": In(LaneReading(width=width, height=height, slots=slots)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        component, reader = self.component, self.reader

        def lane(name, number, value, *, in_result=False):
            m.submodules[name] = words = memory.Memory(
                shape=value.shape(), depth=self._slots + 1, init=[], attrs=NO_COLLISIONS_IN_BLOCK
            )
            write, read = words.write_port(), words.read_port()
            where = Signal.like(reader.place, name=f"where_{name}", reset_less=True)
            is_read = (reader.lane == number) | (reader.lane == Lane.RESULT if in_result else 0)
            m.d.sync += where.eq(Mux(is_read, reader.place, 0))
            m.d.comb += [
                write.addr.eq(self.slot),
                write.data.eq(value),
                write.en.eq(self.write),
                read.addr.eq(where),
            ]
            shown = Signal(value.shape(), name=f"shown_{name}", reset_less=True)
            m.d.sync += shown.eq(read.data)
            return shown

        word = word_layout(**self._sizes)
        extremes = []
        for k, (a, _) in enumerate(DIRECTIONS):
            coded = component.extremes[f"e{k}"]
            along, across = (coded.reach, coded.other) if a else (coded.other, coded.reach)
            value = Signal(data.StructLayout({"reach": len(along), "other": len(across)}), name=f"coded{k}")
            m.d.comb += [value.reach.eq(along), value.other.eq(across)]
            extremes.append(lane(f"extreme{k}", k, value, in_result=k % 4 == 0))
        areas = [
            lane("gap_area", Lane.GAP_AREA, component.gap_area, in_result=True),
            lane("area", Lane.AREA, component.area, in_result=True),
        ]
        sums = [
            lane("gap_sum_x", Lane.GAP_SUM_X, component.gap_sum_x),
            lane("gap_sum_y", Lane.GAP_SUM_Y, component.gap_sum_y),
        ]

        groups = [Signal(word, name=f"group{k}", reset_less=True) for k in range(POINTS // 4)]
        for k, group in enumerate(groups):
            for name in word.members:
                m.d.sync += group[name].eq(_or([extreme[name] for extreme in extremes[4 * k : 4 * k + 4]]))
        joined = Signal(word, reset_less=True)
        for name in word.members:
            m.d.sync += joined[name].eq(_or([group[name] for group in groups]))
        m.d.comb += [
            reader.word.eq(joined),
            reader.area.eq(areas[0] | areas[1]),
            reader.gap_sum.eq(sums[0] | sums[1]),
            reader.box_max.x.eq(extremes[0].reach),
            reader.box_max.y.eq(extremes[4].other),
            reader.box_min.x.eq(~extremes[8].reach),
            reader.box_min.y.eq(~extremes[12].other),
            reader.result_gap_area.eq(areas[0]),
            reader.result_area.eq(areas[1]),
        ]
        return m
