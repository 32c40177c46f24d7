"""A command line that is called and watched."""

import json
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from sim.cli.app import main
from sim.scene import paper_frame, random_marker_scene, render


@pytest.fixture
def sim(capfd):
    """Call ``python -m sim`` with these arguments: code, out, err, and ``json()`` of what was printed."""

    def call(*args):
        code = main([str(arg) for arg in args])
        out, err = capfd.readouterr()
        return SimpleNamespace(code=code, out=out, err=err, json=lambda: json.loads(out))

    return call


@pytest.fixture(scope="session")
def pictures(tmp_path_factory):
    """Folder of pictures that are in order."""
    folder = tmp_path_factory.mktemp("pictures")
    colour = np.random.default_rng(1).integers(0, 256, (48, 64, 3), dtype=np.uint8)
    scene = random_marker_scene(3, count=3, side_px=(50, 120), tilt_deg=(10, 50))
    for name, image in {
        "paper": paper_frame(),
        "three": render(scene).image,
        "noise": colour,
        "least": np.full((16, 16), 255, np.uint8),
        "portrait": np.full((900, 100), 255, np.uint8),
    }.items():
        assert cv2.imwrite(str(folder / f"{name}.png"), image)
    return folder
