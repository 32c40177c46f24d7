"""Programs that measure on the core: their results are the reference's, and what goes wrong is told."""

import dataclasses

import numpy as np
import pytest

from firmware.reference import Camera, Pose, approximations, estimate_pose, pose_covariance
from firmware.reference.angles import atan2_minimax
from firmware.reference.classic import APPROXIMATIONS, classic_poses
from firmware.reference.numbers import Lens
from firmware.toolchain.images import build
from hdl.float.unit import CLOCKS
from sim.engine.build import EngineError
from sim.engine.system import RtlSystem
from sim.measure.frames import (
    five_marker_frames,
    most_markers_frame,
    one_marker_frame,
    run_load,
    stack_used,
)
from sim.measure.functions import FUNCTIONS, LIBRARIES, function_inputs, measure_function
from sim.measure.markers import PAPER_MARKER, markers
from sim.measure.operations import measure_operations
from sim.measure.poses import STOP_ERROR, VARIANTS, Variant, measure_poses
from sim.measure.program import execute
from sim.models.sensor import ModelSensor
from sim.results import Settings


@pytest.fixture(scope="module")
def system():
    return RtlSystem()


def bits(estimates):
    return estimates.tobytes()


def reference(vertices, variant, method):
    return [
        estimate_pose(
            one,
            method=method,
            dtype=np.float32,
            polish_steps=variant.polish_steps,
            max_iterations=variant.max_iterations,
            stop_error=STOP_ERROR,
        )
        for one in vertices
    ]


def assert_equal_bits(pose, expected):
    assert np.array_equal(pose["r"].view(np.uint32), np.asarray(expected.R, np.float32).view(np.uint32))
    assert np.array_equal(pose["t_mm"].view(np.uint32), np.asarray(expected.t_mm, np.float32).view(np.uint32))
    assert pose["rms_px"] == expected.rms_px


@pytest.mark.parametrize(
    "name, method", [("centred", "centred"), ("centred_polish", "centred"), ("classic_exact", "classic")]
)
def test_poses_of_the_core_are_the_references(system, name, method):
    """A second batch too, and a marker in the wrong order in it, which has no pose."""
    vertices = markers(30)
    vertices[25] = vertices[25, ::-1]
    result = measure_poses(system, VARIANTS[name], vertices)
    assert result.clocks.shape == (30,) and result.clocks.min() > 500 and result.cold > result.clocks[0]
    for estimate, expected in zip(result.estimates, reference(vertices, VARIANTS[name], method), strict=True):
        assert estimate["error"] == expected.error.value
        assert estimate["iterations"] == expected.iterations
        assert estimate["has_other"] == (expected.other is not None)
        if expected.pose is not None:
            assert_equal_bits(estimate["pose"], expected.pose)
        if expected.other is not None:
            assert_equal_bits(estimate["other"], expected.other)
    assert result.estimates["error"][25] == 3


def test_poses_by_approximations_are_the_references(system):
    variant = VARIANTS["classic_approximations"]
    vertices = markers(30)
    result = measure_poses(system, variant, vertices)
    for estimate, one in zip(result.estimates, vertices, strict=True):
        (best, iterations), *_ = classic_poses(
            tuple(map(tuple, one)),
            Lens.of(Camera(), np.float32),
            np.float32(113),
            diagonal_px=np.float32(800),
            stop_error=np.float32(STOP_ERROR),
            max_iterations=variant.max_iterations,
            functions=APPROXIMATIONS,
        )
        assert estimate["iterations"] == iterations
        assert np.array_equal(estimate["pose"]["r"], np.array(best.rotation, np.float32))
        assert np.array_equal(estimate["pose"]["t_mm"], np.array(best.t_mm, np.float32))
        assert estimate["pose"]["rms_px"] == best.rms_px
    # The paper's marker, to the digits that it prints.
    assert (result.estimates["pose"]["t_mm"][0, 2], result.estimates["pose"]["r"][0, 2, 2]) == (
        pytest.approx(904.239197, abs=1e-6),
        pytest.approx(1.000529, abs=5e-7),
    )


@pytest.mark.parametrize(
    "image", ["centred", "classic-exact", pytest.param("classic-approximations", marks=pytest.mark.long)]
)
def test_soft_float_is_the_same_arithmetic(system, image):
    """IEEE 754 leaves no choice: the unit and compiler-rt agree bit for bit, and only the clocks differ."""
    vertices = markers(20)
    hardware, software = (
        measure_poses(system, Variant(title=image, image=f"{image}-{floats}"), vertices)
        for floats in ("hardware", "software")
    )
    assert bits(hardware.estimates) == bits(software.estimates)
    assert software.clocks.mean() > 5 * hardware.clocks.mean()


def test_library_functions_are_near_the_exact_root(system):
    """sinf, cosf and atanf round otherwise than a complex root without angles, and no more than that."""
    vertices = markers(10)
    library, exact = (measure_poses(system, VARIANTS[name], vertices) for name in ("classic_library", "classic_exact"))
    assert np.array_equal(library.estimates["error"], exact.estimates["error"])
    assert np.abs(library.estimates["pose"]["r"] - exact.estimates["pose"]["r"]).max() < 1e-3
    assert library.clocks.mean() > exact.clocks.mean()


def test_covariances_are_the_references(system):
    result = measure_poses(system, VARIANTS["covariance"], markers(5))
    for found, estimate in zip(result.covariances, result.estimates, strict=True):
        pose = Pose(estimate["pose"]["r"], estimate["pose"]["t_mm"], estimate["pose"]["rms_px"])
        expected = pose_covariance(pose, Camera(), 113.0)
        assert np.array_equal(found, np.zeros((6, 6)) if expected is None else expected)


def test_limit_of_steps_reaches_the_core(system):
    vertices = markers(3)
    few, many = (
        measure_poses(system, dataclasses.replace(VARIANTS["classic_exact"], max_iterations=limit), vertices)
        for limit in (1, 6)
    )
    assert (few.estimates["iterations"] == 1).all() and many.estimates["iterations"].max() > 1
    assert few.clocks[1:].max() < many.clocks[1:].min()


def test_markers_are_whole_but_the_papers():
    vertices = markers(50)
    assert vertices.shape == (50, 4, 2) and vertices.dtype == np.float32
    assert np.array_equal(vertices[0], PAPER_MARKER) and np.ptp(PAPER_MARKER, axis=0).tolist() == [80, 80]
    assert np.array_equal(vertices[1:], np.rint(vertices[1:])) and np.array_equal(markers(20), vertices[:20])
    assert len(np.unique(vertices, axis=0)) == 50


JUDGED = {
    "sin": approximations.sin_taylor,
    "cos": approximations.cos_taylor,
    "acos": approximations.acos_cubic,
    "atan": approximations.atan_taylor,
    "sqrt": approximations.sqrt_one_step,
    "invsqrt": approximations.invsqrt_one_step,
    "sqrt, 2 steps": approximations.sqrt_two_steps,
    "invsqrt, 2 steps": approximations.invsqrt_two_steps,
    "atan, minimax": lambda x: atan2_minimax(x, np.float32(1)),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_approximations_of_the_core_are_the_references(system, name):
    result = measure_function(system, "approximation", name)
    expected = np.array([JUDGED[name](x) for x in function_inputs(name)], np.float32)
    assert np.array_equal(result.results.view(np.uint32), expected.view(np.uint32))
    assert 10 < result.clocks_mean <= result.clocks_max < 150


def test_square_root_of_the_library_is_the_units(system):
    """Correctly rounded either way; the unit's takes few clocks more than its own."""
    soft, hardware = (measure_function(system, library, "sqrt") for library in ("soft", "hardware"))
    expected = np.sqrt(function_inputs("sqrt"))
    assert np.array_equal(soft.results, expected) and np.array_equal(hardware.results, expected)
    assert CLOCKS["fsqrt"] < hardware.clocks_max < CLOCKS["fsqrt"] + 10 < soft.clocks_mean


@pytest.mark.parametrize("name", ["sin", "cos", "acos", "atan"])
def test_functions_of_the_library_are_good_to_an_ulp_or_two(system, name):
    """For 200 of the inputs; `python -m sim clocks` has all 1,000."""
    result, approximation = (measure_function(system, library, name, 200) for library in ("hardware", "approximation"))
    assert result.error_max < 3e-7 and result.clocks_mean > approximation.clocks_mean


def test_the_library_has_no_approximations(system):
    assert [measure_function(system, library, "atan, minimax") for library in LIBRARIES][:2] == [None, None]


def test_operations(system):
    """A program waits one clock longer than the unit needs: for the result to come back to where operands are."""
    measured = measure_operations(system)
    assert list(measured) == list(CLOCKS)
    assert {name: clocks.unit for name, clocks in measured.items()} == CLOCKS
    assert {name: clocks.program for name, clocks in measured.items()} == {
        name: clocks + 1 for name, clocks in CLOCKS.items()
    }


def test_a_program_that_does_not_end(system, monkeypatch):
    monkeypatch.setattr("sim.measure.program._PATIENCE", 3000)
    with pytest.raises(EngineError) as caught:
        execute(system, "operations-hardware")
    assert str(caught.value) == "the program operations-hardware said b'' instead of done"


def test_a_program_that_traps(system, monkeypatch):
    """All its functions are at an address where none can be."""
    image = build("functions-approximations-hardware")
    nowhere = (bytes(20) + b"\2\0\0\0") * (image.symbols["functions"].size // 24)
    monkeypatch.setattr("sim.measure.program.build", lambda name: image.patched("functions", nowhere))
    with pytest.raises(EngineError) as caught:
        execute(system, "functions-approximations-hardware")
    assert str(caught.value) == "the program functions-approximations-hardware said b'trap\\n' instead of done"


@pytest.fixture(scope="module")
def model():
    return ModelSensor(640, 480)


def test_five_markers_in_every_frame_leave_time_to_spare(system, model):
    settings = Settings()
    load = run_load(system, *five_marker_frames(model, settings, 4), settings)
    assert len(load.lines) == 4 * 6 and load.lines == load.expected
    assert 5 * load.pose_clocks + load.text_clocks < load.frame_clocks < 640 * 480 / 5


def test_a_wrong_sentence_would_be_seen(system, model):
    """The vertices of another frame: the same lines but for the poses."""
    settings = Settings()
    frames, results = five_marker_frames(model, settings, 2)
    load = run_load(system, frames, results[::-1], settings)
    assert load.lines != load.expected and len(load.lines) == len(load.expected)
    assert load.lines[0] == load.expected[0] and load.lines[6] == load.expected[6]


def test_stack_of_many_markers(system, model):
    settings = Settings()
    frame = most_markers_frame()
    (result,) = model.run([frame], settings)
    assert len(result.markers) == 64
    system.start()
    idle = stack_used(system, system.image)
    load = run_load(system, [frame], [result], settings, tick_clocks=5000, display_ticks=1, status_ticks=7)
    assert load.lines == load.expected
    assert 0 < idle < stack_used(system, system.image) < system.image.sizes.stack


def test_one_marker(system, model):
    frame = one_marker_frame()
    load = run_load(system, [frame], model.run([frame], Settings()), Settings())
    assert load.lines == load.expected and len(load.lines) == 2
    assert len(load.traffic.published) == 1
    assert load.frame_clocks < load.traffic.clocks[-1] - load.traffic.published[0] < 20_000
