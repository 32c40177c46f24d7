"""The pose library in C against the float32 reference on 200,000 quads (``make exhaustive``)."""

import pytest

from firmware.host import HostLibrary
from firmware.reference import Camera
from tests.firmware.quads import assert_same_bits, expected, garbage_quads, seen_quads

SHARD = 10_000
CAMERA = Camera()


@pytest.mark.parametrize("shard", range(20))
def test_shard(shard):
    """Four shards in five are markers seen, one is garbage; one in five is polished."""
    quads = (garbage_quads if shard % 5 == 4 else seen_quads)(1000 + shard, SHARD)
    steps = 2 * (shard % 5 == 3)
    answers = HostLibrary(polish_steps=steps).estimate(quads)
    assert_same_bits(answers, expected(quads, CAMERA, 113.0, polish_steps=steps), quads)
