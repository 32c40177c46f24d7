"""The stack of open components: as deep as it can get, and empty again after a cut."""

import numpy as np
import pytest

from tests.hdl.test_segmentation import check, segmentation


def arches(rows, columns):
    """Concentric arches, two columns apart: every one is open while the innermost is scanned."""
    frame = np.zeros((rows, columns), bool)
    for k in range(0, min(rows - 1, columns // 2), 2):
        frame[k, k : columns - k] = True
        frame[k:, [k, columns - 1 - k]] = True
    return frame


@pytest.mark.parametrize("columns", [9, 32, 33, 34, 35, 64])
def test_deepest_stack(columns):
    frame = arches(columns // 2 + 3, columns)
    check(segmentation(columns, 64), [frame, frame, ~frame, frame])


@pytest.mark.parametrize("columns", [33, 64])
def test_cuts_leave_nothing_on_the_stack(columns):
    """Cut again and again in the middle of the legs, where the stack is full."""
    frame = arches(columns // 2 + 3, columns)
    middle = (columns // 2 + 1) * columns + columns // 2
    cuts = [*range(middle - 30, middle + 10), None]
    check(segmentation(columns, 64), [frame] * len(cuts), cuts=cuts)
