"""The whole system's emitted Verilog and its firmware behind one Python class: pictures in, sentences and poses out."""

import ctypes
import dataclasses
import pathlib
from typing import NamedTuple

import numpy as np

from firmware.layout import FRAME_REPORT, MARKER_REPORT, settings_bytes
from firmware.toolchain.images import build
from hdl.config import RAM_BYTES, SensorConfig
from hdl.pixels import CameraPixel
from hdl.regs.map import system_maps
from hdl.system.addresses import RAM, REGISTERS
from hdl.system.cpu import cpu_verilog
from hdl.vision.framer import SETTLING
from sim.engine.build import EngineError, build_library, cached_verilog
from sim.engine.frames import HEADER, camera_pixels, checked_frames, feed_arrays, frame_result, setting_writes

__all__ = ["Report", "RtlSystem", "Traffic"]

_FOLDER = pathlib.Path(__file__).parent
#: Clocks after the last pixel in which the firmware must have told of every frame: 64 markers take 600,000.
_PATIENCE = 4_000_000
#: Looks at a report, 1,000 clocks apart, in which it must be finished.
_POLLS = 1000
#: Clocks in which a reset comes to an end everywhere.
_RESET = 64


class Traffic(NamedTuple):
    """What went over the serial line, and when.

    ``text`` is bytes, ``clocks`` int64 of as many: when each was handed to the UART. ``published`` are the clocks at
    which frames were published while the firmware had noticed all before.
    """

    text: bytes
    clocks: np.ndarray
    published: np.ndarray

    @property
    def lines(self):
        """Complete lines, without their ends."""
        return [line.decode("ascii") for line in self.text.split(b"\r\n")[:-1]]


class Report(NamedTuple):
    """The firmware's results of a frame: records of firmware.layout."""

    frame: np.void
    markers: np.ndarray


class RtlSystem:
    """The system, alive.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.
    image : Image or None
        What the processor runs; None is the sensor's firmware.

    Raises
    ------
    EngineError
        If the engine cannot be built.
    ToolchainError
        If the firmware cannot be built.
    """

    def __init__(self, width=640, height=480, image=None):
        self._handle = None
        self.config = SensorConfig(width=width, height=height)
        self.maps = system_maps(self.config)
        self.image = build("sensor") if image is None else image
        verilog = cached_verilog("rasterpose_system", width, height) + cpu_verilog()
        sources = {
            "driver.cpp": (_FOLDER / "system.cpp").read_text(),
            "camera.h": (_FOLDER / "camera.h").read_text(),
            "registers.h": f"#pragma once\n#define SOF_BIT {CameraPixel.as_shape()['sof'].offset}\n",
        }
        path = build_library(verilog + (_FOLDER / "system_top.v").read_text(), "system_top", sources)
        self._library = library = ctypes.CDLL(str(path))
        for name, result in (
            ("new", ctypes.c_void_p), ("run", ctypes.c_int64), ("clock", ctypes.c_int64), ("failed", ctypes.c_int),
            ("sent", ctypes.POINTER(ctypes.c_uint8)), ("sent_count", ctypes.c_int64),
            ("sent_clock", ctypes.POINTER(ctypes.c_int64)),
            ("published_clock", ctypes.POINTER(ctypes.c_int64)), ("published_count", ctypes.c_int64),
        ):  # fmt: skip
            getattr(library, f"system_{name}").restype = result
        self._handle = ctypes.c_void_p(library.system_new())
        self._loaded = None

    def __del__(self):
        if self._handle:
            self._library.system_delete(self._handle)

    # The host.

    @property
    def clock(self):
        """Clocks since it was made."""
        return self._library.system_clock(self._handle)

    def read_words(self, address, count):
        """``count`` words from a byte address of the processor's space on, uint32."""
        words = np.zeros(count, np.uint32)
        self._library.system_read(
            self._handle, ctypes.c_uint32(address), ctypes.c_void_p(words.ctypes.data), ctypes.c_int64(count)
        )
        self._check()
        return words

    def write_words(self, address, words):
        """Write words from a byte address on. The processor's caches do not see it."""
        words = np.ascontiguousarray(words, np.uint32)
        self._library.system_write(
            self._handle, ctypes.c_uint32(address), ctypes.c_void_p(words.ctypes.data), ctypes.c_int64(len(words))
        )
        self._check()

    def _check(self):
        if self._library.system_failed(self._handle):
            raise EngineError("the system does not answer its host: the hardware is at fault")

    def _register(self, slave, register):
        offset, registers = self.maps[slave]
        entry = registers.register(register)
        return REGISTERS + offset + entry.offset, entry

    def read(self, slave, register):
        """Fields of a register as a dict."""
        address, entry = self._register(slave, register)
        word = int(self.read_words(address, 1)[0])
        return {field.name: word >> field.low & (1 << field.width) - 1 for field in entry.fields}

    def write(self, slave, register, **fields):
        """Write a register; fields that are not named become 0."""
        address, entry = self._register(slave, register)
        self.write_words(address, [sum(int(value) << entry.field(name).low for name, value in fields.items())])

    def idle(self, clocks):
        """Let clocks pass."""
        self._library.system_idle(self._handle, ctypes.c_int64(clocks))

    # The processor.

    def start(self, image=None, boot_clocks=200_000):
        """Reset everything, load the processor's memory and let it run until its first line, or ``boot_clocks``.

        Returns the Traffic until then.
        """
        image = self.image if image is None else image
        self._library.system_reset(self._handle, 1)
        self.idle(_RESET)
        self.write_words(RAM, np.pad(image.words, (0, RAM_BYTES // 4 - len(image.words))))
        self.forget()
        self.halt(False)
        for _ in range(0, boot_clocks, 1000):
            self.idle(1000)
            if b"\n" in self.traffic().text:
                break
        self._loaded = image
        return self.traffic()

    def halt(self, is_halted):
        """Keep the processor in reset, for 16 clocks at least, or let it start anew with what its memory holds."""
        self._library.system_halt(self._handle, int(is_halted))

    def forget(self):
        """Forget the Traffic so far."""
        self._library.system_forget(self._handle)

    def traffic(self):
        """Traffic since the start, or since it was forgotten last."""
        library, handle = self._library, self._handle

        def array(name, dtype):
            count = getattr(library, f"system_{name.split('_')[0]}_count")(handle)
            values = getattr(library, f"system_{name}")(handle)
            return np.ctypeslib.as_array(values, (count,)).copy() if count else np.zeros(0, dtype)

        return Traffic(
            array("sent", np.uint8).tobytes(), array("sent_clock", np.int64), array("published_clock", np.int64)
        )

    def report(self):
        """The firmware's Report of the last frame that it told of.

        Raises
        ------
        EngineError
            If the firmware does not stop writing it.
        """
        address = self._loaded.symbols["report"].address
        for _ in range(_POLLS):
            frame = self.read_words(address, FRAME_REPORT.itemsize // 4).view(FRAME_REPORT)[0]
            if frame["sequence"] % 2 == 0:
                break
            self.idle(1000)
        else:
            raise EngineError("the firmware does not finish its report")
        words = self.read_words(address + FRAME_REPORT.itemsize, MARKER_REPORT.itemsize // 4 * int(frame["markers"]))
        return Report(frame, words.view(MARKER_REPORT))

    # Pictures.

    def configure(self, settings, columns, rows, **firmware):
        """Write every setting of the sensor, and start the firmware with its own if they are new."""
        image = self.image.patched("settings", settings_bytes(self.image, **firmware)) if firmware else self.image
        if self._loaded is None or image.elf != self._loaded.elf:
            self.start(image)
        self.idle(self.config.width + SETTLING)
        for register, fields in setting_writes(settings, columns, rows):
            self.write("sensor", register, **fields)

    def feed(self, pixels, *, idle=None, frames=0, patience=_PATIENCE):
        """Feed raw camera payloads (uint32) with ``idle`` clocks (uint8) before each, or none.

        Goes on until the firmware has told of ``frames`` frames, for ``patience`` clocks at most. Returns the clocks at
        which the pixels marked ``sof`` went in, and the number of frames told of.
        """
        pixels, gaps, fed = feed_arrays(pixels, idle)
        pointers = [None if a is None else ctypes.c_void_p(a.ctypes.data) for a in (pixels, gaps, fed)]
        told = self._library.system_run(
            self._handle, pointers[0], ctypes.c_int64(len(pixels)), pointers[1], pointers[2],
            ctypes.c_int64(frames), ctypes.c_int64(patience),
        )  # fmt: skip
        return fed, told

    def run(self, frame, settings, shown=1, **firmware):
        """FrameResult and Report of one frame.

        Parameters
        ----------
        frame : ndarray
            (H, W) grey or (H, W, 3) RGB uint8.
        settings : Settings
        shown : int
            How often the frame is shown, one after the other has been told of; the last time counts.
        firmware
            Fields of the firmware's settings that are not its defaults.

        Raises
        ------
        ValueError
            If the frame's size is impossible.
        EngineError
            If the firmware did not tell of the frame.
        """
        (frame,), rows, columns = checked_frames([frame], self.config)
        self.configure(settings, columns, rows, **firmware)
        for _ in range(shown):
            self.forget()
            _, told = self.feed(camera_pixels(frame), frames=1)
            if told != 1:
                raise EngineError("the firmware told nothing of the frame")
        result = self.published()
        return dataclasses.replace(result, clocks=rows * columns), self.report()

    def published(self):
        """FrameResult, without clocks, of the frame that is published now."""
        self.write("sensor", "control", **{**self.read("sensor", "control"), "hold": 1})
        header = {name: int(self.read_words(self._register("sensor", name)[0], 1)[0]) for name in HEADER}
        items = {}
        offset, registers = self.maps["sensor"]
        for window in registers.windows:
            name, words = window.name.removesuffix("_window"), window.stride // 4
            if f"{name}s" in header:
                count = header[f"{name}s"] & 0xFFFF
                found = self.read_words(REGISTERS + offset + window.offset, count * words)
                items[f"{name}s"] = found.reshape(-1, words)
        self.write("sensor", "control", **{**self.read("sensor", "control"), "hold": 0})
        return frame_result(header, **items)
