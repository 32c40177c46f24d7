"""The whole sensor's emitted Verilog behind one Python class that takes pictures and gives results."""

import ctypes
import pathlib

import numpy as np

from hdl import emit
from hdl.config import SensorConfig
from hdl.pixels import CameraPixel
from hdl.regs.bus import READ_LATENCY
from hdl.regs.map import sensor_map
from hdl.vision.framer import SETTLING
from sim.engine.build import EngineError, build_library, cached_verilog
from sim.engine.frames import (
    HEADER,
    camera_pixels,
    checked_frames,
    feed_arrays,
    frame_result,
    marker_items,
    setting_writes,
)
from sim.results import FrameResult, Settings

__all__ = ["RtlSensor"]

_DRIVER = pathlib.Path(__file__).with_name("sensor.cpp")
_TOP = pathlib.Path(__file__).with_name("sensor_top.v")
#: Clocks after the last pixel in which every frame must be published: a full queue of candidates takes 11,000.
_PATIENCE = 500_000


class RtlSensor:
    """The sensor, alive.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.

    Attributes
    ----------
    times : list
        (FIRST_PIXEL, LAST_PIXEL) of each frame that the last run published.

    Raises
    ------
    EngineError
        If the engine cannot be built.
    """

    def __init__(self, width=640, height=480):
        self._handle = None
        self.config = SensorConfig(width=width, height=height)
        self.map = sensor_map(self.config)
        self.times = []
        self._offset = {item.name: item.offset for item in (*self.map.registers, *self.map.windows)}
        sources = {
            "driver.cpp": _DRIVER.read_text(),
            "camera.h": _DRIVER.with_name("camera.h").read_text(),
            "registers.h": self._header(),
        }
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

    @property
    def clock(self):
        """Clocks since it was made. The next transfer and the next pixel are on their way in this one."""
        return self._library.sensor_clock(self._handle)

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
        for register, fields in setting_writes(settings, columns, rows):
            self.write(register, **fields)

    def feed(self, pixels, *, idle=None, publications=0, patience=_PATIENCE, live=False):
        """Feed raw camera payloads (uint32) with ``idle`` clocks (uint8) before each, or none.

        Returns the clocks at which the pixels marked ``sof`` went in and the results of the frames published, each
        with its number. Nothing is checked, so this is the way to feed broken frames.
        """
        pixels, gaps, fed = feed_arrays(pixels, idle)
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
        self.times = []
        while len(words):
            header = {name: int(word) for name, word in zip(HEADER, words, strict=False)}
            words, items = words[len(HEADER) :], {}
            for name in ("blob", "corner", "marker"):
                stride = next(w.stride for w in self.map.windows if w.name == f"{name}_window") // 4
                size = stride * (header[f"{name}s"] & 0xFFFF)
                items[f"{name}s"] = words[:size].reshape(-1, stride)
                words = words[size:]
            self.times.append((header["first_pixel"], header["last_pixel"]))
            results.append((header["frame"], frame_result(header, **items)))
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
        if not frames:
            return []
        frames, rows, columns = checked_frames(frames, self.config)
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
        fed, _ = self.feed(camera_pixels(frame), publications=1, patience=200_000, live=True)
        words = 3 + next(w.stride for w in self.map.windows if w.name == "live_window") // 4
        count = self._library.sensor_marker_count(self._handle)
        seen = np.zeros((0, words), np.int64)
        if count:
            seen = np.ctypeslib.as_array(self._library.sensor_markers(self._handle), (count,)).reshape(-1, words).copy()
        markers = marker_items(seen[:, 3:].astype(np.uint32))
        last = fed[0] + markers["box"][:, 3].astype(np.int64) * columns + markers["box"][:, 2]
        return {"markers": markers, "vertices_latency_clocks": seen[:, 0] - last}
