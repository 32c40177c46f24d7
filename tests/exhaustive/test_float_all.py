"""The floating-point unit against Berkeley SoftFloat: two million operands for each operation (``make exhaustive``).

Half of them are uniform bits, half adversarial. The model judges RISC-V's own operations, which SoftFloat lacks.
"""

import numpy as np
import pytest

from sim.engine import StreamEngine
from sim.models.float import FUNCTIONS, compute
from tests.hdl.float_bench import FloatBench, adversarial, check
from tests.models.softfloat import JUDGED, judge

COUNT = 2_000_000
BATCH = 250_000
CASES = [(name, mode) for name, (_, modes) in FUNCTIONS.items() for mode in modes if mode != 7]


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(FloatBench)


@pytest.mark.parametrize("name, mode", CASES)
def test_two_million_operands(engine, name, mode):
    seed = 1000 * (1 + CASES.index((name, mode)))
    judged_by = "SoftFloat" if name in JUDGED else "the model"
    print(f"{name}, rounding mode {mode}: {COUNT:,} operands, seeds from {seed}, judged by {judged_by}", flush=True)
    for batch in range(COUNT // BATCH):
        random = np.random.default_rng(seed + batch)
        uniform = random.integers(0, 1 << 32, (2, BATCH // 2), dtype=np.uint32)
        a, b = np.concatenate([uniform, adversarial(BATCH // 2, seed + batch)], axis=1)
        expected = (judge if name in JUDGED else compute)(name, a, b, mode)
        check(engine, name, a, b, mode, expected)
