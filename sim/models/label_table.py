"""The paper's segmentation as its section 4.2 and Algorithm 1 tell it, to measure where it goes wrong.

It is not what the hardware here does: :mod:`sim.models.segmentation` is. One label a pixel; a row of labels is kept;
a label that leaves the row is looked up once in ``Label_LUT``; two labels that meet become the smaller one, whose entry
the LUT gets at the larger one's place; a component ends when the row below has passed its last pixel without touching
it (``Last_x``). Chains of entries are never resolved: that is what goes wrong, and a component comes out in parts.

What the text leaves open is decided in the scheme's favour:

- The frame has a column of background behind each row and a row of it at its end. Without them what touches the right
  or the lower border would never end.
- A new label is the lowest one that is free. A label is free again when its component ended, as the text says, and
  not when it was merged into another, of which the text says nothing.
- Table 1 does not list P = 1 with P3 alone; the text's rule for one label, copy it, is taken.
- In Algorithm 1, opcode 01, ``wd1`` is assigned only if x is the new least. Read as printed the register keeps what the
  pixel before left in it, which may be another component's; and a pixel that merges two components is itself in
  neither's box. ``printed=True`` does both. By default the register keeps the component's own value and the pixel
  counts, as it surely was meant.
- There are as many labels as are needed.
- The table is updated at once, without the two states that Algorithm 1 takes for it.
"""

import numba
import numpy as np

__all__ = ["label_boxes", "scratch", "walk"]

_NEW, _UPDATE, _MERGE = range(3)


@numba.njit(cache=True)
def _lowest_free(used):
    label = 1
    while used[label]:
        label += 1
    return label


@numba.njit(cache=True)
def _store(table, written, operation, label, other, x, y, printed):
    """Algorithm 1 for xmin, ymin, xmax, ymax; ``written`` are the four registers wd."""
    place = (x, y, x, y)
    for side in range(4):
        sign = 1 if side < 2 else -1
        own, joined, value = sign * table[label, side], sign * table[other, side], sign * place[side]
        if operation == _NEW:
            written[side] = value * sign
        elif operation == _UPDATE:
            if value < own:
                written[side] = value * sign
            elif not printed:
                written[side] = own * sign
        else:
            written[side] = min(own, joined) * sign
        table[label, side] = written[side]


@numba.njit(cache=True)
def walk(foreground, printed, boxes, row, lut, last_x, used, table, written):
    """Boxes of the components in the order in which they end, into ``boxes``; returns how many.

    For callers that have many pictures; the tables are those of ``scratch``.
    """
    rows, columns = foreground.shape
    row[:] = 0
    used[:] = False
    written[:] = 0
    count = 0
    for y in range(rows + 1):
        p1 = p3 = 0
        p4 = lut[row[0]]
        forced = 0  # what the multiplexer puts into P4 instead of the label that was looked up
        for x in range(columns + 1):
            above = row[x + 1] if x + 1 < columns else 0
            p2, p3, p4 = p3, p4, forced if forced and above else lut[above]
            forced = 0
            label = 0
            if y < rows and x < columns and foreground[y, x]:
                left = p1 if p1 else p2
                if p3:
                    label = p3 if p1 and not p2 and not p4 else left if left else p3
                elif left and p4 and left != p4:
                    label, other = min(left, p4), max(left, p4)
                    lut[other] = label
                    _store(table, written, _MERGE, label, other, x, y, printed)
                    p4 = forced = label
                else:
                    label = left if left else p4
                if not label:
                    label = _lowest_free(used)
                    used[label] = True
                    lut[label] = label
                    _store(table, written, _NEW, label, label, x, y, printed)
                elif not (forced and printed):
                    _store(table, written, _UPDATE, label, label, x, y, printed)
            elif p1:
                last_x[p1] = x
            elif p2 and not p3 and last_x[p2] == x:
                boxes[count] = table[p2]
                count += 1
                used[p2] = False
            if x < columns:
                row[x] = label
            p1 = label
    return count


@numba.njit(cache=True)
def scratch(rows, columns):
    """Room for the boxes and the tables of a picture; the tables can be used again."""
    labels = rows * columns + 2
    return (
        np.zeros((labels, 4), np.int32),
        np.zeros(columns, np.int32),
        np.zeros(labels, np.int32),
        np.zeros(labels, np.int32),
        np.zeros(labels, np.bool_),
        np.zeros((labels, 4), np.int32),
        np.zeros(4, np.int32),
    )


def label_boxes(foreground, printed=False):
    """Boxes (x_min, y_min, x_max, y_max) that the paper's scheme tells of a binary picture, in its order, (N, 4).

    Parameters
    ----------
    foreground : (H, W) bool
    printed : bool
        Algorithm 1 to the letter.
    """
    foreground = np.ascontiguousarray(foreground, np.bool_)
    boxes, *tables = scratch(*foreground.shape)
    return boxes[: walk(foreground, printed, boxes, *tables)].copy()
