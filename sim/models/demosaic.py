"""Bayer samples to pixels: the truth for :class:`hdl.camera.demosaic.Demosaic`, and the way back."""

import numpy as np

__all__ = ["as_received", "demosaic", "mosaic"]


def _rows(order):
    """Where the colours are: [(row, column) of R, first G, second G, B] in a cell."""
    places = {"R": [], "G": [], "B": []}
    for at, colour in enumerate(order):
        places[colour].append(divmod(at, 2))
    return places["R"][0], *places["G"], places["B"][0]


def mosaic(picture, order="GRBG"):
    """Samples (2 rows, 2 columns) of 12 bits that a sensor sends of a picture (rows, columns, 3) of 8 bits.

    Each cell sees one pixel. The lowest four bits are the highest, so that full scale stays full scale.
    """
    levels = np.asarray(picture, np.int64) << 4 | np.asarray(picture, np.int64) >> 4
    samples = np.zeros((2 * levels.shape[0], 2 * levels.shape[1]), np.int64)
    for (row, column), colour in zip(_rows(order), (0, 1, 1, 2), strict=True):
        samples[row::2, column::2] = levels[..., colour]
    return samples


def _pixel(cell, order):
    """(3,) of the four samples of a cell, in their order; or of many such cells (N, 4)."""
    red, first, second, blue = (np.asarray(cell)[..., 2 * row + column] for row, column in _rows(order))
    return np.stack([red >> 4, ((first >> 2) + (second >> 2)) >> 3, blue >> 4], axis=-1)


def as_received(picture, order="GRBG"):
    """The picture as it is behind the block."""
    samples = mosaic(picture, order)
    cells = np.stack([samples[0::2, 0::2], samples[0::2, 1::2], samples[1::2, 0::2], samples[1::2, 1::2]], axis=-1)
    return _pixel(cells, order).astype(np.uint8)


def demosaic(level, sof, eol, *, width, order="GRBG"):
    """Pixels of a stream of samples: colours (N, 3), and bool (N,) ``sof`` and ``eol``.

    What of a cell has not been stored because its upper row was short is what is there of rows before; -1 where there
    is nothing yet.
    """
    stored = np.full((width, 2), -1, np.int64)
    colours, starts, ends = [], [], []
    column = row = length = before = 0
    is_start = False
    for value, first, last in zip(np.asarray(level).tolist(), sof, eol, strict=True):
        if first:
            column, row, is_start = 0, 0, True
        cell, odd = column // 2, column % 2
        if odd and cell < width and row == 0:
            stored[cell] = before, value
        elif odd and cell < width:
            above = stored[cell]
            is_known = min(above) >= 0
            colours.append(_pixel([*above, before, value], order) if is_known else [-1, -1, -1])
            starts.append(is_start)
            ends.append(bool(last) and length == column + 1)
            is_start = False
        before, column = value, column + 1
        if last:
            length = column if row == 0 else length
            column, row = 0, 1 - row
    return np.array(colours, np.int64).reshape(-1, 3), np.array(starts, bool), np.array(ends, bool)
