"""The hub: each transfer reaches the one slave in whose addresses it lies, and what they say comes back."""

import numpy as np
import pytest

from hdl.config import SensorConfig
from hdl.regs.map import system_maps
from hdl.system.register_hub import RegisterHub
from hdl.system.system import register_hub
from tests.hdl.memory_bench import play

SIZE = {"width": 64, "height": 48}
SLAVES = {name: (offset // 4, entry.addr_width) for name, (offset, entry) in system_maps(SensorConfig(**SIZE)).items()}


def test_transfers(simulator):
    """Random ones and those at the ends of every slave, one a clock; what peripherals read comes a clock later."""
    random = np.random.default_rng(4)
    edges = [start + step for start, bits in SLAVES.values() for step in (0, 1, (1 << bits) - 1, 1 << bits)]
    address = np.concatenate([edges * 8, random.integers(0, 1 << 15, 500)])
    kind = random.integers(0, 3, len(address))
    pins = {
        "bus__address": address,
        "bus__read": kind == 1,
        "bus__write": kind == 2,
        "bus__write_data": random.integers(0, 1 << 32, len(address)),
    }
    talks = random.integers(0, len(SLAVES) + 1, len(address))
    values = random.integers(0, 1 << 32, len(address))
    pins |= {f"{name}__read_data": np.where(talks == k, values, 0) for k, name in enumerate(SLAVES)}
    trace = play(register_hub(**SIZE), "register_hub", simulator, len(address), pins=pins)
    said = np.where(talks < len(SLAVES), values, 0)
    is_late = talks == list(SLAVES).index("sensor")
    expected = np.where(is_late, said, 0) | np.concatenate([[0], np.where(is_late, 0, said)[:-1]])
    assert (trace["bus.read_data"] == expected).all()
    reached = np.zeros(len(address), int)
    for name, (start, bits) in SLAVES.items():
        hit = (address >= start) & (address < start + (1 << bits))
        reached += hit
        assert (trace[f"{name}.read"] == (hit & (kind == 1))).all(), name
        assert (trace[f"{name}.write"] == (hit & (kind == 2))).all(), name
        assert (trace[f"{name}.address"][hit] == address[hit] - start).all(), name
        assert (trace[f"{name}.write_data"][hit] == trace["bus.write_data"][hit]).all(), name
    assert set(reached.tolist()) == {0, 1}


def test_constructor():
    with pytest.raises(ValueError) as error:
        RegisterHub(addr_width=8, slaves={"fine": (32, 5), "odd": (8, 4)}, early=set())
    assert str(error.value) == "odd must lie at a multiple of its size"
