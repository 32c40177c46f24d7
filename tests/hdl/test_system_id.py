"""What the system says of itself."""

import pytest

from hdl.config import CLOCK_HZ, RAM_BYTES
from hdl.peripherals.system_id import SystemId
from tests.hdl.peripheral_bench import Program, Run


def words(run, simulator=None):
    """All words, after all have been written."""
    program = Program(20)
    for word in range(4):
        program.write(word, 4 * word, 0)
        program.read(4 + word, 4 * word)
    return run(program, simulator)["read_data"][6:10].tolist()


def test_emitted_verilog(simulator):
    assert words(Run(SystemId()), simulator) == [0x52505359, 0x000100, CLOCK_HZ, RAM_BYTES]


def test_another_system():
    run = Run(SystemId(clock_hz=4294967295, ram_bytes=1))
    assert words(run) == [0x52505359, 0x000100, 4294967295, 1]


@pytest.mark.parametrize("name", ["clock_hz", "ram_bytes"])
@pytest.mark.parametrize("value", [0, -1, 1 << 32, 5e7])
def test_values_must_fit(name, value):
    with pytest.raises(ValueError) as error:
        SystemId(**{name: value})
    assert str(error.value) == f"{name} must be an integer from 1 to 4294967295, not {value!r}"
