"""The paper's label table: right where its text makes it right, wrong where its chains make it wrong."""

import numpy as np
import pytest

from sim.evaluation.segmentation import count_failures, exhaust
from sim.models.label_table import label_boxes
from sim.models.segmentation import find_blobs
from tests.patterns import parse


def told(text, printed=False):
    return sorted(map(tuple, label_boxes(parse(text), printed).tolist()))


def true(text):
    return sorted(map(tuple, find_blobs(parse(text))["box"].tolist()))


@pytest.mark.parametrize(
    "text",
    [
        "#",
        "....\n....",
        "##.##",
        "#.# .#.",
        "#...# #...# #####",
        "#.#.# .#.#. #.#.#",
        "### #.# ###",
        "#.. ... ..#",
        "##### #...# #.#.# #...# #####",
        "...# ..#. .#.. #...",
        "#.#.#.# #.#.#.# ###.### ...#...",
        "####. ....# ####. ....#",
    ],
)
def test_simple_pictures_are_right(text):
    assert told(text) == true(text)


def test_components_come_in_the_order_in_which_they_end():
    assert label_boxes(parse("#.# ..# ...")).tolist() == [[0, 0, 0, 0], [2, 0, 2, 1]]


def test_labels_are_used_again():
    picture = np.zeros((9, 300), bool)
    picture[::2, ::2] = True
    assert sorted(map(tuple, label_boxes(picture).tolist())) == sorted(map(tuple, find_blobs(picture)["box"].tolist()))


def test_chain_is_not_followed():
    """Label 3 becomes 2, 2 becomes 1, and the 3 in the row buffer is looked up once: its pixel goes to 2, not to 1."""
    chain = "....# ..#.# ##.#. #...."
    assert true(chain) == [(0, 0, 4, 3)]
    assert (0, 0, 4, 2) in told(chain)
    assert told(".....# ...#.# .##.#. #.....") != true(".....# ...#.# .##.#. #.....")


def test_the_multiplexer_before_p4_counts():
    """The pixel behind a merger is given the new label; looked up instead, the box would end a column earlier."""
    text = ".#...##. .#.#..#. #..###.. ###..###"
    assert told(text) == true(text) == [(0, 0, 7, 3)]


def test_as_printed_a_register_keeps_another_components_column():
    """Two columns side by side: the right one's least x is in the register when the left one's next row comes."""
    sides = "#.# #.# #.#"
    assert told(sides) == true(sides)
    assert told(sides, printed=True) != true(sides)


def test_every_small_picture():
    for width, height in ((4, 4), (3, 5)):
        assert exhaust(width, height)["failures"] == 0
    found = exhaust(5, 4)
    assert (found["pictures"], found["failures"]) == (1 << 20, 48)
    assert len(found["examples"]) == 6
    for rows in found["examples"]:
        assert told(" ".join(rows)) != true(" ".join(rows))
    lit = ["".join(rows).count("#") for rows in found["examples"]]
    assert lit == sorted(lit)


def test_failures_grow_with_the_picture_and_ours_has_none():
    counts = [count_failures(size, 0.4, 200, seed=1) for size in (8, 32, 64)]
    rates = [count["label_table"] / 200 for count in counts]
    assert rates[0] < 0.02 < rates[1] < 0.15 < rates[2] < 0.4
    assert all(count["ours"] == 0 for count in counts)
    assert count_failures(32, 0.4, 200, seed=1) == counts[1]
