"""The build of the host's pose library, and what its users can do wrong."""

import ctypes
import shutil

import numpy as np
import pytest

from firmware.host import ESTIMATE, FOLDERS, HostLibrary, Options, build_library
from firmware.toolchain import ToolchainError
from tests.firmware.quads import GOOD


def copied(folder):
    """A copy of the C files, to be spoilt."""
    return tuple(shutil.copytree(source, folder / source.name) for source in FOLDERS)


def test_a_library_is_built_once():
    path = build_library()
    before = path.stat().st_mtime_ns
    assert build_library() == path
    assert path.stat().st_mtime_ns == before


def test_another_source_is_another_library(tmp_path):
    folders = copied(tmp_path)
    assert build_library(folders=folders) == build_library()
    source = folders[0] / "quad.c"
    source.write_text(source.read_text().replace("#define MAX_SLOPE 1e3f", "#define MAX_SLOPE 0.01f"))
    assert build_library(folders=folders) != build_library()
    assert HostLibrary(folders=folders).estimate(GOOD[None])["error"][0] == 1
    assert HostLibrary().estimate(GOOD[None])["error"][0] == 0


def test_a_compiler_error_is_one_line(tmp_path):
    folders = copied(tmp_path)
    (folders[0] / "square.c").write_text("int spokes(void) { return nothing; }\n")
    with pytest.raises(ToolchainError, match=r"square\.c:1:\d+: error: ") as caught:
        build_library(folders=folders)
    assert "\n" not in str(caught.value)


def test_structures_have_the_headers_sizes():
    assert ESTIMATE.itemsize == 116
    assert ctypes.sizeof(Options) == 36


@pytest.mark.parametrize("shape", [(4, 2), (3, 8), (1, 2, 4), (1, 4, 3)])
def test_wrong_shapes_are_refused(shape):
    with pytest.raises(ValueError, match=r"must have the shape \(N, 4, 2\)"):
        HostLibrary().estimate(np.ones(shape))


def test_unknown_names_are_refused():
    with pytest.raises(ValueError, match=r"^method must be one of centred, classic, not 'posit'"):
        HostLibrary().estimate(GOOD[None], "posit")
    with pytest.raises(ValueError, match=r"^functions must be one of exact, approximations, library, not 'fast'"):
        HostLibrary(functions="fast")


def test_no_markers_have_no_poses():
    assert HostLibrary().estimate(np.empty((0, 4, 2))).shape == (0,)
