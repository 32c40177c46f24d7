"""A camera's marks to frames: the truth for :class:`hdl.vision.framer.Framer`."""

import dataclasses

import numpy as np

__all__ = ["ERRORS", "SETTLING", "Framed", "framer"]

#: The kinds of error, in the order of :class:`hdl.vision.framer.FramerError`.
ERRORS = ("short_line", "long_line", "short_frame", "midline_start", "long_frame", "bad_size")

#: Clocks that a complete frame needs to settle, on top of one for each column.
SETTLING = 64


@dataclasses.dataclass
class Framed:
    """Frames found in a camera's stream; the first four have one entry for each forwarded pixel."""

    beat: np.ndarray  #: int64, which input pixel it is
    first: np.ndarray  #: bool
    eol: np.ndarray  #: bool
    last: np.ndarray  #: bool
    taken: np.ndarray  #: int64 (K, 3): input pixel, columns and rows of every start that was taken
    errors: dict  #: kind -> int64, the input pixels at which it was found


def framer(sof, eol, columns, rows, *, width, height, smallest=1, enable=True, clock=None):
    """Frame a stream that starts after a reset.

    Parameters
    ----------
    sof, eol : array of bool, (N,)
        The marks of every pixel.
    columns, rows : int or array of int, (N,)
        The settings, as they are when each pixel comes.
    width, height : int
        The largest frame that the block was built for.
    smallest : int
        The least number of columns and of rows that it was built for.
    enable : bool or array of bool, (N,)
        Whether frames are taken, as it is when each pixel comes.
    clock : array of int, (N,), optional
        The clock of every pixel, rising; one after the other if it is left out.
    """
    sof, eol = np.asarray(sof, dtype=bool), np.asarray(eol, dtype=bool)
    columns, rows, enable = (np.broadcast_to(setting, sof.shape) for setting in (columns, rows, enable))
    clock = np.arange(len(sof)) if clock is None else np.asarray(clock)
    errors = {kind: [] for kind in ERRORS}
    parts, taken = [np.zeros((4, 0), dtype=np.int64)], []
    last_complete, complete_size = None, None
    starts = np.flatnonzero(sof)
    for start, end in zip(starts, [*starts[1:], len(sof)], strict=True):
        if not enable[start]:
            continue
        size = across, down = int(columns[start]), int(rows[start])
        is_good = smallest <= across <= width and smallest <= down <= height
        if last_complete is not None and clock[start] - last_complete <= complete_size[0] + SETTLING:
            is_good &= size == complete_size
        if not is_good:
            errors["bad_size"].append(start)
            continue
        taken.append((start, *size))
        index = np.arange(min(end - start, across * down))
        ends_row = index % across == across - 1
        wrong = np.flatnonzero(eol[start + index] != ends_row)
        count = int(wrong[0]) if len(wrong) else len(index)
        if len(wrong):
            errors["long_line" if ends_row[count] else "short_line"].append(start + count)
        elif count < across * down:
            if end < len(sof):
                errors["midline_start" if count % across else "short_frame"].append(end)
        else:
            last_complete, complete_size = clock[start + count - 1], size
            if count < end - start:
                errors["long_frame"].append(start + count)
        index = index[:count]
        parts.append(np.stack([start + index, index == 0, ends_row[:count], index == across * down - 1]))
    beat, first, row_end, last = np.concatenate(parts, axis=1)
    return Framed(
        beat,
        first.astype(bool),
        row_end.astype(bool),
        last.astype(bool),
        np.array(taken, dtype=np.int64).reshape(-1, 3),
        {kind: np.array(beats, dtype=np.int64) for kind, beats in errors.items()},
    )
