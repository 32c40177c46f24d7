"""A display with the stores that it reads, a bus that takes them away, and what tests put into them."""

import numpy as np
from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.config import SensorConfig
from hdl.display.display import Display
from hdl.display.timing import VideoMode
from hdl.pixels import ItemKind
from hdl.stores import sensor_stores

__all__ = ["CONFIG", "MODE", "DisplayBench", "beats", "lists"]

CONFIG = SensorConfig(width=64, height=48, blob_depth=32, corner_depth=64, marker_depth=8)

#: A little larger than the frame, with long blanking, so that much fits into a row.
MODE = VideoMode(columns=70, column_front=7, column_sync=31, column_back=212,
                 rows=50, row_front=2, row_sync=3, row_back=4, h_positive=True)  # fmt: skip

#: In the order in which ``i_list`` counts them.
NAMES = ("blob", "corner", "marker")


class DisplayBench(wiring.Component):
    """Beats of all lists come in at one port; ``busy`` is how often of 256 clocks the bus reads."""

    def __init__(self):
        self._sizes = {"width": CONFIG.width, "height": CONFIG.height}
        super().__init__(
            {
                "i_valid": In(1),
                "i_list": In(2),
                "i_kind": In(ItemKind),
                "i": In(128),
                "busy": In(8),
                "late_rows": Out(16),
                "o": Out(27),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.display = display = Display(config=CONFIG, mode=MODE)
        noise = Signal(16, init=1)
        m.d.sync += noise.eq(Cat(noise[1:], noise[0] ^ noise[2] ^ noise[3] ^ noise[5]))
        view, video = display.view, display.o
        m.d.comb += [
            view.free.eq(noise[:8] >= self.busy),
            self.late_rows.eq(display.late_rows),
            self.o.eq(Cat(video.b, video.g, video.r, video.active, video.hsync, video.vsync)),
        ]
        for number, name in enumerate(NAMES):
            depth = getattr(CONFIG, f"{name}_depth")
            store = getattr(sensor_stores, f"{name}_store")(**self._sizes, depth=depth)
            m.submodules[name] = store
            list_view = getattr(view, f"{name}s")
            m.d.comb += [
                store.i_valid.eq(self.i_valid & (self.i_list == number)),
                store.i_kind.eq(self.i_kind),
                store.i.eq(self.i),
                store.read_live.eq(~view.free & noise[9]),
                store.read_addr.eq(Mux(view.free, list_view.index, noise)),
                list_view.data.eq(store.read_data),
                list_view.count.eq(store.count),
                list_view.bank.eq(store.bank),
            ]
        return m


def lists(random, boxes, corners, markers):
    """Random lists of so many items, as :func:`sim.models.painter.codes` wants them."""
    width, height = CONFIG.width, CONFIG.height
    x, y = (np.sort(random.integers(0, size, (boxes, 2))) for size in (width, height))
    places = np.sort(random.choice((width - 6) * (height - 6), corners, replace=False))
    return {
        "boxes": np.stack([x[:, 0], y[:, 0], x[:, 1], y[:, 1]], axis=1),
        "corners": np.stack([places % (width - 6) + 3, places // (width - 6) + 3], axis=1),
        "markers": random.integers(0, (width, height), (markers, 4, 2)),
    }


def _items(name, values):
    """Bits of a list's items; what is not shown is noise."""
    shape = sensor_stores.result_view(CONFIG).members[f"{name}s"].signature.members["data"].shape
    blank = {field: (1 << 4) - 1 for field in ("area", "score", "arc") if field in shape.members}
    for value in np.asarray(values).tolist():
        if name == "marker":
            item = {f"v{k + 1}": {"x": x, "y": y} for k, (x, y) in enumerate(value)}
        else:
            item = dict(zip(("x_min", "y_min", "x_max", "y_max") if name == "blob" else ("x", "y"), value, strict=True))
        yield shape.const(item | blank).as_bits()


def beats(content, *, order=NAMES):
    """``(list, kind, item)`` that publish ``content``, list after list."""
    plural = {"blob": "boxes", "corner": "corners", "marker": "markers"}
    for name in order:
        number = NAMES.index(name)
        for item in _items(name, content[plural[name]]):
            yield number, ItemKind.ITEM.value, item
        yield number, ItemKind.END.value, 0
