"""Single-precision arithmetic as RISC-V wants it, on arrays of bits: the truth for :mod:`hdl.float`.

Operands and results are uint32: the bits of IEEE 754 binary32, or a two's complement integer where an operation
converts one. Arithmetic rounds to nearest, ties to even, and keeps subnormals, as the processor that runs this does;
every NaN that arithmetic makes is :data:`NAN`. The semantics are those of the RISC-V F extension, chapter 20 of the
unprivileged specification 20240411, without its flags.
"""

import numpy as np

__all__ = ["FUNCTIONS", "NAN", "OPERATIONS", "compute", "operation"]

#: The canonical NaN, and the answer to a function that does not exist.
NAN = 0x7FC00000

#: Operation -> (funct7, the funct3 that mean it).
FUNCTIONS = {
    "fadd": (0x00, (0, 7)),
    "fsub": (0x04, (0, 7)),
    "fmul": (0x08, (0, 7)),
    "fdiv": (0x0C, (0, 7)),
    "fsqrt": (0x2C, (0, 7)),
    "fsgnj": (0x10, (0,)),
    "fsgnjn": (0x10, (1,)),
    "fsgnjx": (0x10, (2,)),
    "fmin": (0x14, (0,)),
    "fmax": (0x14, (1,)),
    "fle": (0x50, (0,)),
    "flt": (0x50, (1,)),
    "feq": (0x50, (2,)),
    "fclass": (0x70, (1,)),
    "fcvt.w.s": (0x60, (0, 1, 2, 3, 4, 7)),
    "fcvt.s.w": (0x68, (0, 7)),
}

_SIGN, _MAGNITUDE, _INFINITY = np.uint32(1 << 31), np.uint32(0x7FFFFFFF), np.uint32(0x7F800000)


def _float(bits):
    return bits.view(np.float32)


def _is_nan(bits):
    return bits & _MAGNITUDE > _INFINITY


def _canonical(value):
    bits = value.astype(np.float32).view(np.uint32)
    return np.where(_is_nan(bits), np.uint32(NAN), bits)


def _arithmetic(operator):
    def run(a, b):
        with np.errstate(all="ignore"):
            return _canonical(operator(_float(a), _float(b)))

    return run


def _square_root(a, b):
    with np.errstate(all="ignore"):
        return _canonical(np.sqrt(_float(a)))


def _order(bits):
    """Integers in the order of the numbers, -0 just before +0."""
    magnitude = (bits & _MAGNITUDE).astype(np.int64)
    return np.where(bits & _SIGN, ~magnitude, magnitude)


def _extreme(prefers_b):
    def run(a, b):
        chosen = np.where(prefers_b(_order(b), _order(a)), b, a)
        chosen = np.where(_is_nan(a), b, np.where(_is_nan(b), a, chosen))
        return np.where(_is_nan(a) & _is_nan(b), np.uint32(NAN), chosen)

    return run


def _compare(operator):
    def run(a, b):
        with np.errstate(invalid="ignore"):
            return operator(_float(a), _float(b)).astype(np.uint32)

    return run


def _inject(sign):
    return lambda a, b: a & _MAGNITUDE | sign(a, b) & _SIGN


def _classify(a, b):
    negative, magnitude = a >> 31 == 1, a & _MAGNITUDE
    kind = np.select(
        [magnitude == 0, magnitude < 1 << 23, magnitude < _INFINITY, magnitude == _INFINITY], [0, 1, 2, 3], 4
    )
    # -infinity, -normal, -subnormal, -0, +0, +subnormal, +normal, +infinity; then the two kinds of NaN.
    index = np.where(kind == 4, 8 + (magnitude >> 22 & 1), np.where(negative, 3 - kind, 4 + kind))
    return (1 << index).astype(np.uint32)


_TO_INTEGER = {
    0: np.rint,
    1: np.trunc,
    2: np.floor,
    3: np.ceil,
    4: lambda value: np.trunc(value + np.copysign(0.5, value)),  # Exact: the values are doubles.
    7: np.rint,
}


def _to_integer(a, mode):
    with np.errstate(invalid="ignore"):
        value = np.where(_is_nan(a), np.inf, _float(a)).astype(np.float64)
        whole = np.clip(_TO_INTEGER[mode](value), -(2.0**31), 2.0**31 - 1)
    return whole.astype(np.int64).astype(np.uint32)


_RULES = {
    "fadd": _arithmetic(np.add),
    "fsub": _arithmetic(np.subtract),
    "fmul": _arithmetic(np.multiply),
    "fdiv": _arithmetic(np.divide),
    "fsqrt": _square_root,
    "fsgnj": _inject(lambda a, b: b),
    "fsgnjn": _inject(lambda a, b: ~b),
    "fsgnjx": _inject(lambda a, b: a ^ b),
    "fmin": _extreme(np.less),
    "fmax": _extreme(np.greater),
    "fle": _compare(np.less_equal),
    "flt": _compare(np.less),
    "feq": _compare(np.equal),
    "fclass": _classify,
    "fcvt.s.w": lambda a, b: _canonical(a.view(np.int32)),
}

#: Every operation, by its name in RISC-V assembly without the ``.s`` that they share.
OPERATIONS = tuple(FUNCTIONS)


def operation(function):
    """Name and rounding mode of a 10-bit function, or None if there is no such function."""
    funct7, funct3 = function >> 3, function & 7
    for name, (upper, lower) in FUNCTIONS.items():
        if funct7 == upper and funct3 in lower:
            return name, funct3
    return None


def compute(name, a, b, mode=0):
    """Results of one operation.

    Parameters
    ----------
    name : str
        One of :data:`OPERATIONS`.
    a, b : array of uint32, (N,)
        Operands; ``b`` means nothing to operations that have one operand.
    mode : int
        Rounding mode of ``fcvt.w.s``: 0 to nearest even, 1 towards zero, 2 down, 3 up, 4 to nearest with ties away
        from zero, 7 as 0. The other operations always round to nearest even.
    """
    a, b = (np.ascontiguousarray(operand, dtype=np.uint32) for operand in (a, b))
    return _to_integer(a, mode) if name == "fcvt.w.s" else _RULES[name](a, b)
