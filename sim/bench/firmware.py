"""Clocks and memory of the firmware, on the whole system's Verilog."""

from sim.bench.registry import at_most, each_at_most, measurement

_FRAME = 640 * 480

_FLOAT_TARGETS = {"fadd": 4, "fsub": 4, "fmul": 4, "fdiv": 16, "fsqrt": 16}


def _mean_clocks(bench, name):
    """Mean clocks of a pose by a variant of ``sim.measure.poses``, over its markers."""
    from sim.measure.markers import markers
    from sim.measure.poses import VARIANTS, measure_poses

    variant = VARIANTS[name]
    result = measure_poses(bench.system, variant, markers(variant.markers), progress=bench.progress)
    return float(result.clocks.mean())


@measurement(
    "posit_clocks_classic",
    "Pose by classic POSIT, hardware and approximations, at most 3 steps a branch",
    "clocks",
    target=at_most(15_000),
    needs_rtl=True,
)
def posit_clocks_classic(bench):
    """Mean over 100 markers, by a program that does nothing else."""
    return _mean_clocks(bench, "classic_approximations")


@measurement("posit_clocks_centred", "Pose in the sensor's firmware", "clocks", target=at_most(8000), needs_rtl=True)
def posit_clocks_centred(bench):
    """Mean over the 100 poses of ``system_clocks_five_markers``, with the sentences in between."""
    return bench.five_markers.pose_clocks


@measurement("posit_clocks_soft_float", "The same without the floating-point unit", "clocks", needs_rtl=True)
def posit_clocks_soft_float(bench):
    """Mean over 100 markers of centred POSIT in soft float, by a program that does nothing else."""
    return _mean_clocks(bench, "centred_soft")


@measurement(
    "fpu_clocks",
    "Floating-point instruction to one that needs its result",
    "clocks",
    target=each_at_most(_FLOAT_TARGETS),
    needs_rtl=True,
)
def fpu_clocks(bench):
    """Dict of mnemonic to clocks."""
    from sim.measure.operations import measure_operations

    return {name: clocks.program for name, clocks in measure_operations(bench.system).items()}


@measurement(
    "system_clocks_five_markers",
    "Firmware's work on a frame with five markers, 20 frames without a gap",
    "clocks",
    target=at_most(_FRAME // 5),
    needs_rtl=True,
)
def system_clocks_five_markers(bench):
    """From taking a frame to its last sentence, mean; raises RuntimeError if a sentence is not the reference's."""
    load = bench.five_markers
    if load.lines != load.expected:
        right = sum(line in set(load.expected) for line in load.lines)
        raise RuntimeError(f"{right} of {len(load.expected)} sentences are those of the reference")
    return load.frame_clocks


@measurement(
    "firmware_bytes", "Firmware and the stack that 64 markers use", "bytes", target=at_most(32_768), needs_rtl=True
)
def firmware_bytes(bench):
    """Code, constants, variables and the deepest stack, with interrupts, display and status within the frame."""
    from sim.measure.frames import most_markers_frame, run_load, stack_used

    frame = most_markers_frame()
    often = {"tick_clocks": 5000, "display_ticks": 1, "status_ticks": 7}
    load = run_load(bench.system, [frame], bench.model.run([frame], bench.settings), bench.settings, **often)
    if len(load.lines) != 1 + 64:
        raise RuntimeError(f"the firmware told of {len(load.lines) - 1} of 64 markers")
    image = bench.system.image
    return image.sizes.used + stack_used(bench.system, image)


@measurement("pose_latency_clocks", "Marker's frame published to its pose told", "clocks", needs_rtl=True)
def pose_latency_clocks(bench):
    """From the clock in which the vertices can be read to that of the last byte handed to the UART, one marker."""
    from sim.measure.frames import one_marker_frame, run_load

    frame = one_marker_frame()
    traffic = run_load(bench.system, [frame], bench.model.run([frame], bench.settings), bench.settings).traffic
    return int(traffic.clocks[-1] - traffic.published[0])
