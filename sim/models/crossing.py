"""What may be missing behind :class:`hdl.camera.crossing.Crossing`: ends of frames, and nothing else."""

__all__ = ["frames_lost"]


def frames_lost(given, came, is_start):
    """Number of frames of which pixels are missing.

    Parameters
    ----------
    given, came : sequence
        Pixels before and behind the crossing, the first of them one that starts a frame. They must differ from each
        other as far as the answer depends on it.
    is_start : callable
        Whether a pixel starts a frame.

    Raises
    ------
    ValueError
        If what came is no row of frames that were given, each as it was or without its end.
    """
    given, at, lost = list(given), 0, 0
    for index, pixel in enumerate(came):
        if at < len(given) and given[at] == pixel:
            at += 1
            continue
        lost += at < len(given) and not is_start(given[at])  # The frame that was cut.
        while at < len(given) and not (is_start(given[at]) and given[at] == pixel):
            lost += bool(is_start(given[at]))
            at += 1
        if at == len(given):
            raise ValueError(f"pixel {index} that came was not given, or not there")
        at += 1
    rest = given[at:]
    return lost + (bool(rest) and not is_start(rest[0])) + sum(bool(is_start(pixel)) for pixel in rest)
