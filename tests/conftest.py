"""Fixtures for all tests."""

import pytest


def pytest_configure(config):
    """A constructor that raises, as tests of constructor errors want, leaves an unused component behind.

    One that the hardware itself forgot to use still shows: tests/hdl/test_verilog.py wants emission to be
    silent.
    """
    config.addinivalue_line("filterwarnings", "ignore::amaranth.hdl.UnusedElaboratable")


@pytest.fixture(params=["verilator", "icarus"])
def simulator(request):
    """Each simulator for :func:`tests.hdl.harness.cocotb_run`; skipped, saying why, where it is missing."""
    from tests.hdl import harness  # Not needed where no simulator is.

    reason = harness.missing(request.param)
    if reason:
        pytest.skip(reason)
    return request.param
