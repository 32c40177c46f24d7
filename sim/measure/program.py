"""Programs of ``firmware/measure`` on the simulated system: inputs patched into the image, results read from memory."""

import numpy as np

from firmware.toolchain.images import build
from sim.engine.build import EngineError

__all__ = ["constants", "execute", "read_array", "read_number"]

_PATIENCE = 30_000_000
"""Clocks in which a program must have ended."""


def execute(system, image, job=None):
    """Run an image to its end on an RtlSystem, and return the image as it was loaded.

    Parameters
    ----------
    system : RtlSystem
        It is reset, and runs another program afterwards only if that is started.
    image : str
        A name of :data:`firmware.toolchain.images.IMAGES`.
    job : bytes or None
        Contents of the program's ``job``; None if it has none.

    Raises
    ------
    EngineError
        If the program does not end, or ends in a trap.
    ToolchainError
        If the image cannot be built, or has no such job.
    """
    loaded = build(image)
    if job is not None:
        loaded = loaded.patched("job", job)
    text = system.start(loaded, boot_clocks=_PATIENCE).text
    if text != b"done\n":
        raise EngineError(f"the program {image} said {text!r} instead of done")
    return loaded


def read_array(system, image, symbol, dtype):
    """All of an array of ``dtype``, a multiple of 4 bytes, in the memory of an image that has run."""
    place = image.symbols[symbol]
    return system.read_words(place.address, place.size // 4).view(dtype)


def read_number(system, image, symbol):
    """A ``uint32_t``."""
    return int(read_array(system, image, symbol, np.uint32)[0])


def constants(image, symbol, dtype):
    """All of a constant array of ``dtype`` as it lies in an image, as an array."""
    place = image.symbols[symbol]
    return image.words[place.address // 4 : (place.address + place.size) // 4].view(dtype)
