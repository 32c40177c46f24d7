"""When published frames came in: the truth for :class:`hdl.stores.frame_times.FrameTimes`."""

import numpy as np

__all__ = ["frame_times"]


def frame_times(first, last, taken, clocks, *, bits=32):
    """What the block says in each of ``clocks`` clocks after a reset.

    Parameters
    ----------
    first, last : array of int
        Clocks of the strobes for the first and the last pixels of frames, rising.
    taken : array of int
        Clocks of the marks that publish a frame, rising: each means the frame whose last pixel came last before.
    clocks : int
    bits : int
        Width of a time.

    Returns
    -------
    dict
        ``time``, ``first_pixel`` and ``last_pixel``: int64 (clocks,).
    """
    first, last, taken = (np.asarray(events, dtype=np.int64) for events in (first, last, taken))
    clock = np.arange(clocks)
    ends = last[np.searchsorted(last, taken) - 1]
    starts = first[np.searchsorted(first, ends) - 1]
    published = np.searchsorted(taken, clock)  # how many, before this clock

    def told(events):
        return np.concatenate([[2], events])[published] - 2 & (1 << bits) - 1

    return {"time": clock - 1 & (1 << bits) - 1, "first_pixel": told(starts), "last_pixel": told(ends)}
