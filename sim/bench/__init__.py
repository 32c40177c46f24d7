"""Figures of the whole sensor with their targets; ``registry`` says what a measurement is."""

from sim.bench import accuracy, firmware, latency, speed  # noqa: F401 - they register themselves, in this order
from sim.bench.context import Bench
from sim.bench.registry import MEASUREMENTS, Measurement, Target, at_least, at_most, each_at_most, exactly, measurement

__all__ = [
    "MEASUREMENTS",
    "Bench",
    "Measurement",
    "Target",
    "at_least",
    "at_most",
    "each_at_most",
    "exactly",
    "measurement",
]
