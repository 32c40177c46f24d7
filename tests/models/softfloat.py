"""Berkeley SoftFloat as the judge of single-precision arithmetic: about half a microsecond for each result."""

import numpy as np
import softfloatpy as softfloat

__all__ = ["JUDGED", "judge"]


def _numbers(bits):
    data = bits.astype(">u4").tobytes()
    return [softfloat.Float32.from_bytes(data[k : k + 4]) for k in range(0, len(data), 4)]


def _bits(values):
    return np.frombuffer(b"".join([value.to_bytes() for value in values]), ">u4").astype(np.uint32)


def _binary(function):
    def run(a, b, mode):
        return _bits(map(function, _numbers(a), _numbers(b)))

    return run


def _compare(function):
    def run(a, b, mode):
        return np.array([bool(result) for result in map(function, _numbers(a), _numbers(b))], np.uint32)

    return run


def _square_root(a, b, mode):
    return _bits(value.sqrt() for value in _numbers(a))


def _to_integer(a, b, mode):
    rounding = softfloat.RoundingMode(0 if mode == 7 else mode)
    return _bits(softfloat.f32_to_i32(value, rounding) for value in _numbers(a))


def _from_integer(a, b, mode):
    data = a.astype(">u4").tobytes()
    words = (softfloat.Int32.from_bytes(data[k : k + 4]) for k in range(0, len(data), 4))
    return _bits(softfloat.i32_to_f32(word) for word in words)


_RULES = {
    "fadd": _binary(softfloat.f32_add),
    "fsub": _binary(softfloat.f32_sub),
    "fmul": _binary(softfloat.f32_mul),
    "fdiv": _binary(softfloat.f32_div),
    "fsqrt": _square_root,
    "fle": _compare(softfloat.f32_le),
    "flt": _compare(softfloat.f32_lt),
    "feq": _compare(softfloat.f32_eq),
    "fcvt.w.s": _to_integer,
    "fcvt.s.w": _from_integer,
}

#: Operations that SoftFloat has; the others are RISC-V's own.
JUDGED = tuple(_RULES)


def judge(name, a, b, mode=0):
    """Results of an operation as SoftFloat has them; arguments as for :func:`sim.models.float.compute`."""
    return _RULES[name](a, b, mode)
