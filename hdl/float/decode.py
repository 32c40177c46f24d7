"""Functions of the RISC-V F extension that the unit knows, and which of them an instruction means.

``function`` is ``{funct7, funct3}`` of an OP-FP instruction. What a single-precision unit leaves out of it: the
unsigned conversions differ from the signed ones in a field that is no part of it, and fused operations have an opcode
of their own.
"""

from amaranth import Module
from amaranth.lib import enum, wiring
from amaranth.lib.wiring import In, Out

__all__ = ["FUNCTIONS", "Decode", "Operation"]


class Operation(enum.Enum, shape=4):
    """What to do; where sign injections, extremes and compares differ, ``funct3`` tells."""

    UNKNOWN = 0
    ADD = 1
    SUBTRACT = 2
    MULTIPLY = 3
    DIVIDE = 4
    SQUARE_ROOT = 5
    INJECT_SIGN = 6
    EXTREME = 7
    COMPARE = 8
    CLASSIFY = 9
    TO_INTEGER = 10
    FROM_INTEGER = 11


_NEAREST_EVEN = (0, 7)  # 7 is the dynamic mode, which is never another one here.

#: Operation -> (funct7, the funct3 that it may have). Everything else is unknown.
FUNCTIONS = {
    Operation.ADD: (0x00, _NEAREST_EVEN),
    Operation.SUBTRACT: (0x04, _NEAREST_EVEN),
    Operation.MULTIPLY: (0x08, _NEAREST_EVEN),
    Operation.DIVIDE: (0x0C, _NEAREST_EVEN),
    Operation.SQUARE_ROOT: (0x2C, _NEAREST_EVEN),
    Operation.INJECT_SIGN: (0x10, (0, 1, 2)),
    Operation.EXTREME: (0x14, (0, 1)),
    Operation.COMPARE: (0x50, (0, 1, 2)),
    Operation.CLASSIFY: (0x70, (1,)),
    Operation.TO_INTEGER: (0x60, (0, 1, 2, 3, 4, 7)),
    Operation.FROM_INTEGER: (0x68, _NEAREST_EVEN),
}


class Decode(wiring.Component):
    """Tell what a function means. Combinational.

    Members
    -------
    function : :py:`In(10)`
        funct7 above funct3.
    operation : :py:`Out(Operation)`
    """

    function: In(10)
    operation: Out(Operation)

    def elaborate(self, platform):
        m = Module()
        with m.Switch(self.function):
            for operation, (funct7, modes) in FUNCTIONS.items():
                with m.Case(*(funct7 << 3 | funct3 for funct3 in modes)):
                    m.d.comb += self.operation.eq(operation)
        return m
