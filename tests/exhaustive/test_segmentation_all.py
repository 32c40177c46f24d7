"""Segmentation against its model: sets of small images too large for every day (``make exhaustive``).

All images of 4 rows of 6 columns hold the smallest chain failure; all of 3 rows of 7, which hold the smallest
stale label, run with the normal tests, and turned here.
"""

import pytest

from tests.hdl.test_segmentation import segmentation
from tests.hdl.test_segmentation_small import check_all

SHARD = 1 << 19


def check_shard(rows, columns, shard, gap):
    """One shard of all images, with a line that tells how far it is."""
    check_all(segmentation(columns, rows), rows, columns, shard * SHARD, (shard + 1) * SHARD, gap)
    print(
        f"{rows} rows of {columns}: images up to {(shard + 1) * SHARD:,} of {1 << rows * columns:,}",
        flush=True,
    )


@pytest.mark.parametrize("shard", range(4))
def test_every_image_of_seven_rows_of_three(shard):
    """Two idle clocks between frames, as frames of three columns need."""
    check_shard(7, 3, shard, gap=2)


@pytest.mark.parametrize("shard", range(32))
def test_every_image_of_four_rows_of_six(shard):
    check_shard(4, 6, shard, gap=0)
