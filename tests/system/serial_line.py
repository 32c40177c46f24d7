"""What goes over a serial line, bit by bit."""

import numpy as np

__all__ = ["levels", "received"]


def levels(changes, period_ns, end):
    """Level of the line in each clock until ``end``, given (ns, level) of its changes."""
    at, level = changes.T
    return np.repeat(level, np.diff(np.append(at // period_ns, end)))


def received(level, divisor):
    """Bytes of a line, every bit of which must last for its ``divisor`` clocks."""
    text, at = [], 0
    while at < len(level):
        if level[at]:
            at += 1
            continue
        frame = level[at : at + 10 * divisor]
        if len(frame) < 10 * divisor:
            break  # Cut by a reset.
        cells = frame.reshape(10, divisor)
        assert (cells == cells[:, :1]).all() and cells[9, 0] == 1, f"a torn byte at clock {at}"
        text.append(sum(int(bit) << k for k, bit in enumerate(cells[1:9, 0])))
        at += 10 * divisor
    return bytes(text)
