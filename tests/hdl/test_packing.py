"""Payload bits to fields and back, and frames to payloads."""

import numpy as np
import pytest
from amaranth import signed, unsigned
from amaranth.lib import data, enum

from hdl.pixels import BinaryPixel, CameraPixel, GreyPixel
from sim.engine import fields, pack
from tests.hdl.harness import binary_beats, camera_beats, grey_beats


class Colour(enum.Enum, shape=unsigned(2)):
    RED = 1
    BLUE = 2


class Inner(data.Struct):
    x: signed(33)
    y: unsigned(5)


class Wide(data.Struct):
    low: unsigned(7)
    inner: Inner
    levels: data.ArrayLayout(signed(20), 3)
    colour: Colour
    long: unsigned(64)


def test_fields_of_every_kind():
    random = np.random.default_rng(4)
    bits = [int.from_bytes(random.bytes(24), "little") & (1 << 171) - 1 for _ in range(200)]
    words = np.array([[value >> 32 * index & 0xFFFFFFFF for index in range(6)] for value in bits], dtype=np.uint32)
    rows = fields(words, Wide)
    assert rows.dtype.names == ("low", "inner.x", "inner.y", "levels", "colour", "long")

    def number(value, offset, width, signed_=False):
        value = value >> offset & (1 << width) - 1
        return value - (1 << width) if signed_ and value >> width - 1 else value

    for row, value in zip(rows.tolist(), bits, strict=True):
        levels = [number(value, 45 + 20 * index, 20, True) for index in range(3)]
        assert (*row[:3], row[3].tolist() if hasattr(row[3], "tolist") else list(row[3]), *row[4:]) == (
            number(value, 0, 7),
            number(value, 7, 33, True),
            number(value, 40, 5),
            levels,
            number(value, 105, 2),
            number(value, 107, 64),
        )


def test_pack_is_the_inverse_of_fields():
    rows = {"x": np.array([-(1 << 32), -1, (1 << 32) - 1]), "y": [0, 31, 7]}
    back = fields(pack(Inner, **rows), Inner)
    assert back["x"].tolist() == rows["x"].tolist() and back["y"].tolist() == rows["y"]
    assert fields(pack(unsigned(9), value=[1, 511]), unsigned(9))["value"].tolist() == [1, 511]


@pytest.mark.parametrize(
    "arrays, phrase",
    [
        ({"x": 0}, "Fields must be x, y, not x"),
        ({"x": 0, "y": [32]}, "Field 'y' must be in 0 to 31"),
        ({"x": [1 << 32], "y": 0}, "Field 'x' must be in -4294967296 to 4294967295"),
    ],
)
def test_pack_errors(arrays, phrase):
    with pytest.raises(ValueError) as error:
        pack(Inner, **arrays)
    assert str(error.value) == phrase


def test_frames_to_beats():
    frames = [np.arange(6).reshape(2, 3), np.arange(6, 12).reshape(3, 2)]
    rows = fields(grey_beats(frames, cut=[4, None]), GreyPixel)
    assert rows["level"].tolist() == [0, 1, 2, 3, 6, 7, 8, 9, 10, 11]
    assert rows["first"].tolist() == [1, 0, 0, 0, 1, 0, 0, 0, 0, 0]
    assert rows["eol"].tolist() == [0, 0, 1, 0, 0, 1, 0, 1, 0, 1]
    assert rows["last"].tolist() == [0] * 9 + [1]
    rows = fields(camera_beats([np.arange(12).reshape(2, 2, 3)]), CameraPixel)
    assert rows[["r", "g", "b", "sof", "eol"]].tolist() == [
        (0, 1, 2, 1, 0),
        (3, 4, 5, 0, 1),
        (6, 7, 8, 0, 0),
        (9, 10, 11, 0, 1),
    ]
    assert fields(binary_beats([frames[0]]), BinaryPixel)["foreground"].tolist() == [0, 1, 1, 1, 1, 1]
