"""The whole sensor's emitted Verilog behind one Python class that takes pictures and gives results."""

import ctypes
import pathlib

import numpy as np

from hdl import emit
from hdl.config import SMALLEST_FRAME, SensorConfig
from hdl.pixels import CameraPixel
from hdl.regs.bus import READ_LATENCY
from hdl.regs.map import sensor_map
from hdl.vision.framer import SETTLING
from sim.engine.build import EngineError, build_library, cached_verilog
from sim.engine.packing import pack
from sim.models.fast import CORNER
from sim.models.matching import MARKER
from sim.results import BOX, FrameResult, Settings

__all__ = ["RtlSensor"]

_DRIVER = pathlib.Path(__file__).with_name("sensor.cpp")
_TOP = pathlib.Path(__file__).with_name("sensor_top.v")
_HEADER_WORDS = 6  # frame, blobs, small blobs, corners, markers, candidates dropped
#: Clocks after the last pixel in which every frame must be published: a full queue of candidates takes 6,000.
_PATIENCE = 100_000


def _low(word):
    return (word & 0xFFFF).astype(np.int64)


def _high(word):
    return (word >> 16).astype(np.int64)


def _pairs(words):
    """x and y of words (N, K) as (N, K, 2)."""
    return np.stack([_low(words), _high(words)], axis=-1)


def _markers(words):
    markers = np.zeros(len(words), MARKER)
    markers["vertices"] = _pairs(words[:, :4])
    markers["box"] = _pairs(words[:, 4:6]).reshape(-1, 4)
    markers["area"], markers["gap_area"] = words[:, 6], words[:, 7]
    return markers


def camera_pixels(frame):
    """Payloads of one frame, (H, W) grey or (H, W, 3) RGB uint8, as uint32 (H W,)."""
    rows, columns = frame.shape[:2]
    colours = frame.reshape(-1, 3).T if frame.ndim == 3 else np.broadcast_to(frame.reshape(-1), (3, rows * columns))
    index = np.arange(rows * columns)
    return pack(
        CameraPixel, r=colours[0], g=colours[1], b=colours[2], sof=index == 0, eol=index % columns == columns - 1
    ).astype(np.uint32)


class RtlSensor:
    """The sensor, alive.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.

    Raises
    ------
    EngineError
        If the engine cannot be built.
    """

    def __init__(self, width=640, height=480):
        self._handle = None
        self.config = SensorConfig(width=width, height=height)
        self.map = sensor_map(self.config)
        self._offset = {item.name: item.offset for item in (*self.map.registers, *self.map.windows)}
        sources = {"driver.cpp": _DRIVER.read_text(), "registers.h": self._header()}
        verilog = cached_verilog(emit.TOP, width, height) + _TOP.read_text()
        path = build_library(verilog, _TOP.stem, sources)
        self._library = ctypes.CDLL(str(path))
        for name, result in (
            ("new", ctypes.c_void_p), ("words", ctypes.POINTER(ctypes.c_uint32)), ("word_count", ctypes.c_int64),
            ("markers", ctypes.POINTER(ctypes.c_int64)), ("marker_count", ctypes.c_int64),
            ("clock", ctypes.c_int64), ("read", ctypes.c_uint32), ("run", ctypes.c_int64),
        ):  # fmt: skip
            getattr(self._library, f"sensor_{name}").restype = result
        self._handle = ctypes.c_void_p(self._library.sensor_new())
        self.reset()

    def __del__(self):
        if self._handle:
            self._library.sensor_delete(self._handle)

    def _header(self):
        """registers.h: what sensor.cpp has to know of the map."""
        values = {item.name.upper(): item.offset for item in (*self.map.registers, *self.map.windows)}
        values |= {f"{window.name.split('_')[0].upper()}_WORDS": window.stride // 4 for window in self.map.windows}
        for name, register, field in (
            ("CONTROL_HOLD", "control", "hold"),
            ("STATUS_HELD", "status", "held"),
            ("IRQ_PUBLISHED", "irq_status", "published"),
        ):
            values[name] = 1 << self.map.register(register).field(field).low
        values |= {
            "READ_LATENCY": READ_LATENCY + 1,  # sensor_top.v has a register on the way
            "SOF_BIT": CameraPixel.as_shape()["sof"].offset,
        }
        return "#pragma once\n" + "".join(f"#define {name} {value}\n" for name, value in values.items())

    def reset(self):
        """Pulse ``rst`` and enable the interrupt that tells of published frames."""
        self._library.sensor_reset(self._handle)
        self.write("control", enable=1)
        self.write("irq_enable", published=1)

    def write(self, register, **fields):
        """Write a register; fields that are not named become 0."""
        entry = self.map.register(register)
        value = sum(int(number) << entry.field(name).low for name, number in fields.items())
        self._library.sensor_write(self._handle, entry.offset, ctypes.c_uint32(value))

    def read(self, register):
        """Fields of a register as a dict."""
        entry = self.map.register(register)
        word = self.read_word(entry.offset)
        return {field.name: word >> field.low & (1 << field.width) - 1 for field in entry.fields}

    def read_word(self, offset):
        """The 32-bit word at a byte address, for instance in a window."""
        return self._library.sensor_read(self._handle, ctypes.c_uint32(offset))

    def configure(self, settings, columns, rows):
        """Write every setting; it holds for frames that start later. Waits until the last frame is settled."""
        self._library.sensor_idle(self._handle, ctypes.c_int64(self.config.width + SETTLING))
        self.write("control", enable=1, bright=settings.bright)
        self.write("frame_size", columns=columns, rows=rows)
        self.write("threshold", level=settings.threshold)
        self.write("fast", threshold=settings.fast_threshold, n=settings.fast_n, max_arc=settings.max_arc)
        self.write("blob_min", width=settings.blob_min_width, height=settings.blob_min_height)
        self.write("blob_min_area", pixels=settings.blob_min_area)
        self.write("marker_min", side=settings.marker_min_side)

    def feed(self, pixels, *, idle=None, publications=0, patience=_PATIENCE, live=False):
        """Feed raw camera payloads (uint32) with ``idle`` clocks (uint8) before each, or none.

        Returns the clocks at which the pixels marked ``sof`` went in and the results of the frames published, each
        with its number. Nothing is checked, so this is the way to feed broken frames.
        """
        pixels = np.ascontiguousarray(pixels, np.uint32)
        sof = CameraPixel.as_shape()["sof"].offset
        fed = np.zeros(np.count_nonzero(pixels >> sof & 1), np.int64)
        gaps = None if idle is None else np.ascontiguousarray(idle, np.uint8)
        if gaps is not None and len(gaps) != len(pixels):
            raise ValueError(f"idle must have one entry for each of {len(pixels)} pixels, not {len(gaps)}")
        pointers = [None if a is None else ctypes.c_void_p(a.ctypes.data) for a in (pixels, gaps, fed)]
        self._library.sensor_run(
            self._handle, pointers[0], ctypes.c_int64(len(pixels)), pointers[1], pointers[2],
            ctypes.c_int64(publications), ctypes.c_int64(patience), int(live),
        )  # fmt: skip
        return fed, self._published()

    def _words(self):
        count = self._library.sensor_word_count(self._handle)
        if not count:
            return np.zeros(0, np.uint32)
        return np.ctypeslib.as_array(self._library.sensor_words(self._handle), (count,)).copy()

    def _published(self):
        """[(frame number, FrameResult without clocks)] of the last run."""
        words, results = self._words(), []
        while len(words):
            number, blobs, small, corners, markers, lost = (int(w) for w in words[:_HEADER_WORDS])
            words = words[_HEADER_WORDS:]
            stored = []
            for count, window in ((blobs, "blob"), (corners, "corner"), (markers, "marker")):
                stride = next(w.stride for w in self.map.windows if w.name == f"{window}_window") // 4
                size = stride * (count & 0xFFFF)
                stored.append(words[:size].reshape(-1, stride))
                words = words[size:]
            boxes = np.zeros(len(stored[0]), BOX)
            boxes["box"] = _pairs(stored[0][:, :2]).reshape(-1, 4)
            boxes["area"] = stored[0][:, 2]
            found = np.zeros(len(stored[1]), CORNER)
            found["x"], found["y"] = _low(stored[1][:, 0]), _high(stored[1][:, 0])
            detail = stored[1][:, 1]
            found["score"], found["arc"], found["bright"] = detail & 0xFF, detail >> 8 & 0x1F, detail >> 16 & 1
            result = FrameResult(
                blobs=boxes, blobs_dropped=blobs >> 16, blobs_small=small & 0xFFFF,
                corners=found, corners_dropped=corners >> 16,
                markers=_markers(stored[2]), markers_dropped=markers >> 16,
                candidates_dropped=lost & 0xFFFF,
            )  # fmt: skip
            results.append((number, result))
        return results

    def run(self, frames, settings=Settings(), gap=0):  # noqa: B008 - frozen
        """Results of ``frames``, fed one after the other.

        Parameters
        ----------
        frames : list of ndarray
            (H, W) grey or (H, W, 3) RGB uint8, all of one size.
        settings : Settings
        gap : int
            Clocks without a pixel before each frame, 0 to 255. None are needed, except that frames of a few thousand
            pixels end faster than their results can be read.

        Returns
        -------
        list of FrameResult

        Raises
        ------
        ValueError
            If the frames' sizes differ or are impossible.
        EngineError
            If a frame's results were not published.
        """
        frames = [np.asarray(frame, np.uint8) for frame in frames]
        if not frames:
            return []
        rows, columns = frames[0].shape[:2]
        if any(frame.shape[:2] != (rows, columns) for frame in frames):
            raise ValueError("all frames of a run must have one size")
        if not (SMALLEST_FRAME <= columns <= self.config.width and SMALLEST_FRAME <= rows <= self.config.height):
            raise ValueError(
                f"a frame must be {SMALLEST_FRAME} x {SMALLEST_FRAME} to "
                f"{self.config.width} x {self.config.height} pixels, not {columns} x {rows}"
            )
        self.configure(settings, columns, rows)
        self.write("irq_status", published=1)  # What an earlier run did not wait for.
        pixels = np.concatenate([camera_pixels(frame) for frame in frames])
        idle = np.zeros(len(pixels), np.uint8)
        idle[:: rows * columns] = gap
        fed, published = self.feed(pixels, idle=idle, publications=len(frames))
        numbers = [number for number, _ in published]
        if len(published) != len(frames) or numbers != list(range(numbers[0], numbers[0] + len(frames))):
            raise EngineError(
                f"{len(frames)} frames went in, {len(published)} came out: "
                "they end faster than they can be read; run them with a larger gap"
            )
        clocks = [*np.diff(fed), rows * columns]
        return [
            FrameResult(**{**vars(result), "clocks": int(clock)})
            for (_, result), clock in zip(published, clocks, strict=True)
        ]

    def measure_latency(self, frame, settings=Settings()):  # noqa: B008 - frozen
        """How long the markers of one frame take until they can be read.

        Each marker is read from the live window as soon as polling the register LIVE shows it; a poll takes 2 clocks.
        Markers that the frame's end overtakes are read from the published frame.

        Returns
        -------
        dict
            ``markers``: :data:`MARKER` array; ``vertices_latency_clocks``: for each, clocks from the last pixel of its
            last row going in to its last word being read.
        """
        frame = np.asarray(frame, np.uint8)
        rows, columns = frame.shape[:2]
        self.configure(settings, columns, rows)
        fed, _ = self.feed(camera_pixels(frame), publications=1, patience=20_000, live=True)
        words = 3 + next(w.stride for w in self.map.windows if w.name == "live_window") // 4
        count = self._library.sensor_marker_count(self._handle)
        seen = np.zeros((0, words), np.int64)
        if count:
            seen = np.ctypeslib.as_array(self._library.sensor_markers(self._handle), (count,)).reshape(-1, words).copy()
        markers = _markers(seen[:, 3:].astype(np.uint32))
        last = fed[0] + markers["box"][:, 3].astype(np.int64) * columns + markers["box"][:, 2]
        return {"markers": markers, "vertices_latency_clocks": seen[:, 0] - last}
