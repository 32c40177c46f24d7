"""The whole sensor: camera pixels and a register bus in, results behind the bus and an interrupt out. Wiring only."""

from amaranth import Module, Mux
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.config import SMALLEST_FRAME, SensorConfig
from hdl.pixels import CameraPixel, unstalled
from hdl.regs.bank import RegisterBank
from hdl.regs.bus import READ_LATENCY, RegisterBus
from hdl.regs.map import sensor_map
from hdl.stores import sensor_stores
from hdl.stores.frame_counter import FrameCounter
from hdl.stores.frame_times import FrameTimes
from hdl.vision.corners import Corners
from hdl.vision.framer import Framer
from hdl.vision.grey import Grey
from hdl.vision.matching.matching import Matching
from hdl.vision.refining.refining import Refining
from hdl.vision.segmentation.segmentation import Segmentation
from hdl.vision.size_filter import SizeFilter
from hdl.vision.threshold import Threshold

__all__ = ["Sensor", "sensor"]


class Sensor(wiring.Component):
    """RasterPose without the soft core.

    ::

        camera -> framer -> grey -> threshold -> segmentation -> size filter -> publisher -> box store
                                |                                                |   ^
                                |                                                v   |
                                |                                             matching -> refining -> marker store
                                |-> edges, within refining ---------------------------------'
                                |      '-> level -> threshold
                                '-> corners ------------------------------> publisher -> corner store

    Throughput: one pixel a clock, any gaps or none. Latency: a marker is readable in the live window 7 rows and
    some 3,000 clocks after its last row; a frame is published when its last marker is refined.

    Parameters
    ----------
    config : SensorConfig
    has_view : bool
        There is a second reader of the published results, such as a display.

    Members
    -------
    camera : In(unstalled(CameraPixel))
    bus : In(RegisterBus)
        See ``hdl/registers.rdl``.
    irq : Out(1)
    view : In(ResultView(...))
        With ``has_view``: see :class:`~hdl.stores.result_view.ResultView`.
    """

    def __init__(self, *, config=None, has_view=False):
        self._config = config or SensorConfig()
        self._bank = RegisterBank(registers=sensor_map(self._config), read_latency=READ_LATENCY)
        self._has_view = has_view
        super().__init__(
            {
                "camera": In(unstalled(CameraPixel)),
                "bus": In(RegisterBus(self._bank.map.addr_width)),
                "irq": Out(1),
            }
            | ({"view": In(sensor_stores.result_view(self._config))} if has_view else {})
        )

    def elaborate(self, platform):
        m = Module()
        config = self._config
        sizes = {"width": config.width, "height": config.height}
        m.submodules.registers = registers = self._bank
        m.submodules.framer = framer = Framer(**sizes, smallest=SMALLEST_FRAME)
        m.submodules.grey = grey = Grey()
        m.submodules.threshold = threshold = Threshold()
        m.submodules.segmentation = segmentation = Segmentation(**sizes)
        m.submodules.size_filter = size_filter = SizeFilter(**sizes)
        m.submodules.corners = corners = Corners(**sizes)
        m.submodules.matching = matching = Matching(**sizes, depth=config.candidate_depth)
        m.submodules.refining = refining = Refining(
            **sizes, depth=2 * config.candidate_depth, ring_depth=config.edge_depth
        )
        m.submodules.publisher = publisher = sensor_stores.publisher(**sizes)

        # Pixels.
        connect(m, flipped(self.bus), registers.bus)
        m.d.comb += [
            self.irq.eq(registers.irq),
            framer.i.payload.eq(self.camera.payload),
            framer.i.valid.eq(self.camera.valid),
            threshold.i.payload.eq(grey.o.payload),
            threshold.i.valid.eq(grey.o.valid),
            corners.i.payload.eq(grey.o.payload),
            corners.i.valid.eq(grey.o.valid),
            refining.pixels.payload.eq(grey.o.payload),
            refining.pixels.valid.eq(grey.o.valid),
        ]
        connect(m, framer.o, grey.i)
        connect(m, threshold.o, segmentation.i)

        # Results.
        connect(m, segmentation.o, size_filter.i)
        connect(m, size_filter.o, publisher.i_blob)
        connect(m, corners.o, publisher.i_corner)
        connect(m, matching.o, refining.i)
        connect(m, refining.o, publisher.i_marker)
        m.d.comb += [
            matching.i.payload.eq(segmentation.o.payload),
            matching.i.valid.eq(segmentation.o.valid),
            matching.kept.payload.eq(publisher.o_blob.payload),
            matching.kept.valid.eq(publisher.o_blob.valid),
        ]
        self._connect_settings(m, registers, framer, threshold, size_filter, corners, matching, publisher)
        self._connect_refining(m, registers, framer, threshold, refining)
        self._connect_events(m, registers, framer, segmentation, matching, refining, publisher)
        stores, addresses = self._connect_stores(m, registers, publisher)
        self._connect_readers(m, publisher, stores, addresses)
        self._connect_counters(m, registers, size_filter, matching, publisher)
        self._connect_times(m, registers, framer, publisher)
        return m

    @staticmethod
    def _connect_settings(m, registers, framer, threshold, size_filter, corners, matching, publisher):
        m.d.comb += [
            framer.enable.eq(registers.control.enable),
            framer.columns.eq(registers.frame_size.columns),
            framer.rows.eq(registers.frame_size.rows),
            threshold.bright.eq(registers.control.bright),
            corners.n.eq(registers.fast.n),
            corners.threshold.eq(registers.fast.threshold),
            corners.max_arc.eq(registers.fast.max_arc),
            corners.suppress.eq(1),
            size_filter.min_width.eq(registers.blob_min.width),
            size_filter.min_height.eq(registers.blob_min.height),
            size_filter.min_area.eq(registers.blob_min_area.pixels),
            matching.columns.eq(framer.frame_columns),
            matching.rows.eq(framer.frame_rows),
            matching.min_side.eq(registers.marker_min.side),
            publisher.hold.eq(registers.control.hold | registers.hold.keep),
        ]

    @staticmethod
    def _connect_refining(m, registers, framer, threshold, refining):
        m.d.comb += [
            refining.threshold.eq(registers.threshold.level),
            refining.is_automatic.eq(registers.threshold.automatic),
            threshold.level.eq(refining.level),
            registers.level.threshold.eq(refining.level),
            refining.bright.eq(registers.control.bright),
            refining.contrast.eq(registers.edge.contrast),
            refining.columns.eq(framer.frame_columns),
            refining.rows.eq(framer.frame_rows),
        ]

    @staticmethod
    def _connect_events(m, registers, framer, segmentation, matching, refining, publisher):
        m.d.comb += [
            registers.status.valid.eq(publisher.valid),
            registers.status.held.eq(publisher.held),
            registers.status.pending.eq(publisher.pending),
            registers.frame.number.eq(publisher.frame),
            registers.live.frame.eq(publisher.live_frame),
            registers.irq_status.published_set.eq(publisher.published),
            registers.flags.candidate_overflow_set.eq(matching.dropped),
            registers.flags.queue_overflow_set.eq(segmentation.overflow | matching.overflow | refining.overflow),
            registers.flags.refining_overflow_set.eq(refining.dropped),
            registers.frames_complete.count_incr.eq(publisher.complete),
            registers.frames_skipped.count_incr.eq(publisher.skipped),
            registers.short_lines.count_incr.eq(framer.o_error.short_line),
            registers.long_lines.count_incr.eq(framer.o_error.long_line),
            registers.short_frames.count_incr.eq(framer.o_error.short_frame),
            registers.midline_starts.count_incr.eq(framer.o_error.midline_start),
            registers.long_frames.count_incr.eq(framer.o_error.long_frame),
            registers.bad_sizes.count_incr.eq(framer.o_error.bad_size),
        ]

    def _connect_stores(self, m, registers, publisher):
        sizes = {"width": self._config.width, "height": self._config.height}
        stores = {}
        for name, stream, depth, counts, overflow in (
            ("blob", publisher.o_blob, self._config.blob_depth, registers.blobs, "blob_overflow_set"),
            ("corner", publisher.o_corner, self._config.corner_depth, registers.corners, "corner_overflow_set"),
            ("marker", publisher.o_marker, self._config.marker_depth, registers.markers, "marker_overflow_set"),
        ):
            store = stores[name] = getattr(sensor_stores, f"{name}_store")(**sizes, depth=depth)
            m.submodules[f"{name}_store"] = store
            m.d.comb += [
                store.i_valid.eq(stream.valid),
                store.i_kind.eq(stream.payload.kind),
                *(store.i[field].eq(stream.payload[field]) for field, _ in store.i.shape()),
                counts.count.eq(store.count),
                counts.dropped.eq(store.dropped),
                getattr(registers.flags, overflow).eq(store.overflow),
            ]
        m.d.comb += [
            registers.live.markers.eq(stores["marker"].live_count),
            registers.irq_status.marker_set.eq(stores["marker"].stored),
        ]

        shown, item = registers.items.blob, stores["blob"].read_data
        addresses = {"blob": registers.blob_window.index}
        m.d.comb += [
            shown.box_min.x.eq(item.x_min),
            shown.box_min.y.eq(item.y_min),
            shown.box_max.x.eq(item.x_max),
            shown.box_max.y.eq(item.y_max),
            shown.area.pixels.eq(item.area),
        ]
        shown, item = registers.items.corner, stores["corner"].read_data
        addresses["corner"] = registers.corner_window.index
        m.d.comb += [
            shown.position.x.eq(item.x),
            shown.position.y.eq(item.y),
            *(getattr(shown.detail, field).eq(item[field]) for field in ("score", "arc", "bright")),
        ]
        published, live, item = registers.marker_window, registers.live_window, stores["marker"].read_data
        # One read port for all: the registers X1 to Y4 have it whenever no window is asked.
        addresses["marker"] = Mux(published.select | live.select, published.index, registers.marker_address.marker)
        for name, _ in item.shape():
            register = getattr(registers.items.marker, name)
            if name.endswith("area"):
                m.d.comb += register.pixels.eq(item[name])
            elif name == "quality":
                m.d.comb += [getattr(register, field).eq(item[name][field]) for field, _ in item[name].shape()]
            else:
                m.d.comb += [register.x.eq(item[name].x), register.y.eq(item[name].y)]
        for vertex in range(1, 5):
            m.d.comb += [
                getattr(registers, f"x{vertex}").column.eq(item[f"v{vertex}"].x),
                getattr(registers, f"y{vertex}").row.eq(item[f"v{vertex}"].y),
            ]
        return stores, addresses

    def _connect_readers(self, m, publisher, stores, addresses):
        """The bus has the stores' read ports; a view has them in clocks without a read on the bus."""
        live = self._bank.live_window.select
        if not self._has_view:
            m.d.comb += [stores[name].read_addr.eq(address) for name, address in addresses.items()]
            m.d.comb += stores["marker"].read_live.eq(live)
            return
        m.d.comb += [
            stores["marker"].read_live.eq(live & self.bus.read),
            self.view.free.eq(~self.bus.read),
            self.view.published.eq(publisher.published),
        ]
        for name, address in addresses.items():
            store, view = stores[name], getattr(self.view, f"{name}s")
            m.d.comb += [
                store.read_addr.eq(Mux(self.bus.read, address, view.index)),
                view.data.eq(store.read_data),
                view.count.eq(store.count),
                view.bank.eq(store.bank),
            ]

    @staticmethod
    def _connect_counters(m, registers, size_filter, matching, publisher):
        m.submodules.small_blobs = small_blobs = FrameCounter()
        m.submodules.lost_candidates = lost_candidates = FrameCounter()
        for counter, event, stream, value in (
            (small_blobs, size_filter.small, publisher.o_blob, registers.blobs_small.count),
            # Before markers wait to be refined, or those lost meanwhile would count for the frame before.
            (lost_candidates, matching.dropped, matching.o, registers.candidates_dropped.count),
        ):
            m.d.comb += [
                counter.i_valid.eq(stream.valid),
                counter.i_kind.eq(stream.payload.kind),
                counter.event.eq(event),
                value.eq(counter.count),
            ]

    @staticmethod
    def _connect_times(m, registers, framer, publisher):
        m.submodules.frame_times = times = FrameTimes()
        m.d.comb += [
            times.first.eq(framer.frame_started),
            times.last.eq(framer.frame_complete),
            times.i_valid.eq(publisher.o_blob.valid),
            times.i_kind.eq(publisher.o_blob.payload.kind),
            registers.time.clocks.eq(times.time),
            registers.first_pixel.clocks.eq(times.first_pixel),
            registers.last_pixel.clocks.eq(times.last_pixel),
        ]


def sensor(*, width, height):
    """The sensor with stores of the usual sizes, for frames of up to ``width`` x ``height`` pixels."""
    return Sensor(config=SensorConfig(width=width, height=height))
