"""C to an image for the soft core, by PyPI's ``ziglang`` alone."""

from firmware.toolchain.compile import build_image
from firmware.toolchain.errors import ToolchainError
from firmware.toolchain.image import Image

__all__ = ["Image", "ToolchainError", "build_image"]
