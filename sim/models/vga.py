"""A monitor that knows one video mode, and refuses what is not exactly that.

It is given what its cable carries, a sample a pixel clock, and makes pictures of it. A real monitor is more patient;
this one raises :class:`Violation` for a sync pulse that is too long, too short, of the wrong polarity or not where it
belongs, for colour while the beam is blanked, and for a blanking signal that says something else.

Source: VESA DMT 1.13. A row is counted from the beginning of its active part.
"""

import numpy as np

__all__ = ["VgaMonitor", "Violation"]


class Violation(Exception):  # noqa: N818 - a rule of the standard, not an error of the program
    """The mode forbids what came over the cable."""


def _need(holds, text):
    if not holds:
        raise Violation(text)


def _edges(level):
    """Indices of the first samples of pulses, and of those after them."""
    step = np.diff(level.astype(np.int8))
    return np.flatnonzero(step == 1) + 1, np.flatnonzero(step == -1) + 1


def _pulses(level, length, period, name):
    """Indices of the beginnings of a sync line's pulses, all of which must have their length and distance."""
    begins, ends = _edges(level)
    _need(len(begins) > 1, f"{name} has {len(begins)} pulses")
    _need((np.diff(begins) == period).all(), f"{name} has a period of {np.unique(np.diff(begins))}, not {period}")
    ends = ends[ends > begins[0]]
    lengths = ends - begins[: len(ends)]
    _need((lengths == length).all(), f"{name} lasts for {np.unique(lengths)}, not {length}")
    return begins


class VgaMonitor:
    """A monitor.

    Parameters
    ----------
    mode : VideoMode
        See :mod:`hdl.display.timing`.
    """

    def __init__(self, mode):
        self._mode = mode

    def pictures(self, hsync, vsync, rgb, active=None):
        """All whole pictures, (rows, columns, 3) uint8.

        ``hsync``, ``vsync`` and ``active`` are the levels of each clock, ``rgb`` (clocks, 3) its colours.

        Raises
        ------
        Violation
            If it is not this mode, or if there is no whole picture.
        """
        mode, (width, height) = self._mode, (self._mode.total_columns, self._mode.total_rows)
        h_begins = _pulses(np.asarray(hsync) == mode.h_positive, mode.column_sync, width, "hsync")
        v_level = np.asarray(vsync) == mode.v_positive
        v_begins = _pulses(v_level, mode.row_sync * width, width * height, "vsync")
        _need(np.isin(_edges(v_level)[0], h_begins).all(), "vsync does not begin with hsync")

        # From the beginning of vsync to the first pixel.
        offset = mode.column_sync + mode.column_back + (mode.row_sync + mode.row_back) * width
        rgb = np.asarray(rgb, np.uint8)
        seen = []
        for begin in v_begins + offset:
            part = slice(begin, begin + width * height)
            if part.stop > len(rgb):
                break
            colours = rgb[part].reshape(height, width, 3)
            shown = np.zeros((height, width), bool)
            shown[: mode.rows, : mode.columns] = True
            _need(not colours[~shown].any(), "there is colour while the beam is blanked")
            if active is not None:
                _need((np.asarray(active)[part].reshape(shown.shape) == shown).all(), "the blanking signal is wrong")
            seen.append(colours[: mode.rows, : mode.columns].copy())
        _need(seen, "there is no whole picture")
        return seen
