"""A clock domain of a board whose clock is not the one that the reset is made in."""

from amaranth import ClockDomain, ClockSignal, ResetSignal
from amaranth.lib.cdc import FFSynchronizer

__all__ = ["clocked_by"]


def clocked_by(m, name, clock, reset):
    """Add domain ``name`` with this clock, and with ``reset`` taken over by two registers, and ``NAME_pin`` without it.

    It is in reset from configuration on. A clock that stands still keeps it there, or out of it.
    """
    for domain, is_reset_less in ((name, False), (f"{name}_pin", True)):
        m.domains += ClockDomain(domain, reset_less=is_reset_less)
        m.d.comb += ClockSignal(domain).eq(clock)
    m.submodules[f"{name}_reset"] = FFSynchronizer(reset, ResetSignal(name), o_domain=f"{name}_pin", init=1)
