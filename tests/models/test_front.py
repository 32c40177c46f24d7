"""The front's models against definitions of their own."""

import numpy as np
import pytest

from sim.models.framer import framer
from sim.models.grey import grey
from sim.models.threshold import threshold


@pytest.mark.parametrize(
    "colour", [(0, 0, 0), (255, 255, 255), (3, 1, 3), (4, 2, 4), (255, 0, 0), (0, 255, 0), (7, 9, 201)]
)
def test_grey_is_a_sum_of_shifted_colours(colour):
    red, green, blue = colour
    assert grey(np.array(colour)) == red // 4 + green // 2 + blue // 4


def test_grey_of_a_grey_picture():
    levels = np.arange(256)
    assert (grey(np.stack([levels] * 3, axis=-1)) == 2 * (levels >> 2) + (levels >> 1)).all()


def test_threshold_is_strict_and_its_polarities_are_complements():
    levels = np.arange(256)
    assert threshold(levels, 100).sum() == 100
    assert not threshold(levels, 0).any() and threshold(levels, 0, bright=True).all()
    assert (threshold(levels, 77) != threshold(levels, 77, bright=True)).all()


def test_framer_on_two_good_frames():
    framed = framer([1, 0, 0, 0, 1, 0, 0, 0], [0, 1, 0, 1, 0, 1, 0, 1], 2, 2, width=2, height=2)
    assert framed.beat.tolist() == list(range(8))
    assert framed.last.tolist() == [False, False, False, True] * 2
    assert not any(len(beats) for beats in framed.errors.values())
