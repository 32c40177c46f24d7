"""Payload bits to named fields and back, from the Amaranth layout that the hardware uses."""

import numpy as np
from amaranth import Shape
from amaranth.lib import data

__all__ = ["fields", "pack"]


def _layout(shape):
    """The layout behind a shape, or None if it is a scalar."""
    try:
        return data.Layout.cast(shape)
    except TypeError:
        return None


def _leaves(shape, offset=0, path=()):
    """Yield ``(name, offset, width, signed, length)`` of every scalar, or array of ``length`` scalars."""
    layout = _layout(shape)
    name = ".".join(path) or "value"
    if layout is None:
        scalar = Shape.cast(shape)
        yield name, offset, scalar.width, scalar.signed, None
    elif isinstance(layout, data.ArrayLayout) and _layout(layout.elem_shape) is None:
        scalar = Shape.cast(layout.elem_shape)
        yield name, offset, scalar.width, scalar.signed, layout.length
    else:
        for key, field in layout:
            yield from _leaves(field.shape, offset + field.offset, (*path, str(key)))


def _bits(words, offset, width):
    """``width`` bits from ``offset`` of every row of ``words``, as uint64."""
    first, shift = divmod(offset, 32)
    value = words[:, first].astype(np.uint64) >> np.uint64(shift)
    for index in range(first + 1, (offset + width - 1) // 32 + 1):
        value |= words[:, index].astype(np.uint64) << np.uint64(32 * (index - first) - shift)
    return value & np.uint64((1 << width) - 1)


def _number(value, width, signed):
    if signed:
        unused = np.uint64(64 - width)
        return (value << unused).view(np.int64) >> unused.view(np.int64)
    return value if width == 64 else value.astype(np.int64)


def fields(captured, layout):
    """The fields of captured payloads as a structured array, one row a beat.

    Scalars become int64 (uint64 if they are unsigned and have 64 bits); an array of scalars becomes a
    subarray; a field of a nested structure is called ``outer.inner``. ``layout`` may be a plain shape: its
    only field is ``value``. ``captured`` may also be the uint32 words ``(N, words)`` or packed uint64 values
    ``(N,)`` themselves.
    """
    words = np.asarray(getattr(captured, "payload", captured))
    if words.ndim == 1:
        words = words.astype(np.uint64).view(np.uint32).reshape(-1, 2)
    leaves = list(_leaves(layout))
    needed = max(offset + width * (length or 1) for _, offset, width, _, length in leaves)
    if needed > 32 * words.shape[1]:
        raise ValueError(f"The layout has {needed} bits, the payload only {words.shape[1]} words of 32")
    kinds = []
    for name, _, width, signed, length in leaves:
        kind = np.uint64 if width == 64 and not signed else np.int64
        kinds.append((name, kind) if length is None else (name, kind, (length,)))
    rows = np.zeros(len(words), dtype=kinds)
    for name, offset, width, signed, length in leaves:
        if length is None:
            rows[name] = _number(_bits(words, offset, width), width, signed)
        else:
            for index in range(length):
                rows[name][:, index] = _number(_bits(words, offset + index * width, width), width, signed)
    return rows


def pack(layout, **arrays):
    """Payloads (uint64) of a layout of up to 64 bits, from an array or a number for each of its fields."""
    leaves = {name: (offset, width, signed) for name, offset, width, signed, _ in _leaves(layout)}
    if leaves.keys() != arrays.keys():
        raise ValueError(f"Fields must be {', '.join(leaves)}, not {', '.join(arrays)}")
    payload = np.zeros(np.broadcast_shapes((1,), *(np.shape(array) for array in arrays.values())), dtype=np.uint64)
    for name, array in arrays.items():
        offset, width, signed = leaves[name]
        if offset + width > 64:
            raise ValueError(f"Field {name!r} ends beyond bit 63")
        array = np.asarray(array)
        low, high = (-(1 << width - 1), (1 << width - 1) - 1) if signed else (0, (1 << width) - 1)
        if array.size and not (low <= int(array.min()) and int(array.max()) <= high):
            raise ValueError(f"Field {name!r} must be in {low} to {high}")
        if array.dtype != np.uint64:
            array = array.astype(np.int64).view(np.uint64) if array.ndim else np.uint64(int(array) & (1 << 64) - 1)
        payload |= (array & np.uint64((1 << width) - 1)) << np.uint64(offset)
    return payload
