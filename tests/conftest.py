"""Fixtures for all tests."""

import pytest


def pytest_configure(config):
    """A constructor that raises, as tests of constructor errors want, leaves an unused component behind.

    One that the hardware itself forgot to use still shows: tests/hdl/test_verilog.py wants emission to be
    silent.
    """
    config.addinivalue_line("filterwarnings", "ignore::amaranth.hdl.UnusedElaboratable")


def _usable(simulator):
    from tests.hdl import harness  # Not needed where no simulator is.

    if reason := harness.missing(simulator):
        pytest.skip(reason)
    return simulator


@pytest.fixture(params=["verilator", "icarus"])
def simulator(request):
    """Each simulator for :func:`tests.hdl.harness.cocotb_run`; skipped, saying why, where it is missing."""
    return _usable(request.param)


@pytest.fixture(params=["verilator", pytest.param("icarus", marks=pytest.mark.long)])
def large_simulator(request):
    """The same for what takes Icarus long, or has others of its block beside it: there `make exhaustive` runs it."""
    return _usable(request.param)
