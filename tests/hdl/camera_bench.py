"""Cameras that are set up and played: programs for tb_camera.py, and what came of them."""

from typing import NamedTuple

import numpy as np

from hdl.emit import to_verilog
from hdl.pixels import CameraPixel
from sim.engine import fields
from tests.hdl.harness import simulate

__all__ = ["State", "check_reset", "check_set_up_again", "colours", "play"]


class State(NamedTuple):
    """How things stand after a step of the program."""

    done: int
    failed: int
    reset_n: int
    transfers: int
    writes: int
    beats: int
    lost: int


def play(component, name, simulator, program, *, table, sync_ps, pins="i2c", videos=(), is_fast=False):
    """(State after each step, [(ns, register, value)], payloads) of a component that sets up a camera with a table.

    ``videos`` are dicts of pins and their levels in each clock of the camera.
    """
    arrays = {
        "program": [(*step, 0, 0)[:3] for step in program],
        "slave": [table.address, table.register_bytes, table.value_bytes, is_fast],
        "sync_ps": sync_ps,
        "pins": pins,
        "video": np.array(list(videos[0]) if videos else [], str),
    }
    for number, video in enumerate(videos):
        arrays |= {f"{number}.{pin}": np.asarray(levels, np.int64) for pin, levels in video.items()}
    captured = simulate(
        name, to_verilog(component, name), simulator, arrays, size="camera", testbench="tests.hdl.tb_camera"
    )
    states = [State(*line) for line in captured["log"].tolist()]
    return states, [tuple(write) for write in captured["writes"].tolist()], captured["beats"]


def colours(payloads):
    """(N, 3) of pixels, ``sof`` and ``eol``."""
    found = fields(np.asarray(payloads, np.uint32).reshape(-1, 1), CameraPixel)
    return np.stack([found[name] for name in "rgb"], axis=-1), found["sof"] != 0, found["eol"] != 0


def check_reset(found, expected):
    """Of two pictures (2, H, W, 3) a reset cut the first: what came before is right, the rest of it is missing, and the
    next is whole."""
    seen, sof, eol = found
    _, rows, columns, _ = expected.shape
    expected, size = expected.reshape(-1, 3), rows * columns
    before = len(seen) - size
    assert columns < before < size - columns
    assert (seen[:before] == expected[:before]).all() and (seen[before:] == expected[size:]).all()
    index = np.append(np.arange(before), np.arange(size))
    assert (sof == (index == 0)).all() and (eol == (index % columns == columns - 1)).all()


def check_set_up_again(state, writes):
    """All writes came twice."""
    again = len(writes) // 2
    assert state.done and [write[1:] for write in writes[again:]] == [write[1:] for write in writes[:again]]
