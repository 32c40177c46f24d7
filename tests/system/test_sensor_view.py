"""A second reader of the published results: it is given whole items of published lists, and the bus notices nothing."""

import numpy as np

from hdl import emit
from hdl.config import SensorConfig
from hdl.sensor import Sensor
from hdl.stores.sensor_stores import result_view
from sim.engine.frames import camera_pixels
from sim.models.refine import Quality
from sim.models.sensor import ModelSensor
from tests.shapes import marker_frame, marker_grid
from tests.system.test_sensor_cocotb import REFINING, check, encoded, pauses, pixel_clocks, play

SIZE = (64, 48)


def point(values):
    x, y = (int(value) for value in values)
    return {"x": x, "y": y}


def items(result):
    """Fields of all items of the three lists."""
    yield [
        dict(zip(("x_min", "y_min", "x_max", "y_max", "area"), [*blob["box"].tolist(), int(blob["area"])], strict=True))
        for blob in result.blobs
    ]
    yield [{name: int(corner[name]) for name in ("x", "y", "score", "arc", "bright")} for corner in result.corners]
    yield [
        {
            **{f"v{k + 1}": point(marker["vertices"][k]) for k in range(4)},
            "box_min": point(marker["box"][:2]),
            "box_max": point(marker["box"][2:]),
            "area": int(marker["area"]),
            "gap_area": int(marker["gap_area"]),
            **{f"offset{k + 1}": point(marker["offsets"][k]) for k in range(4)},
            "quality": {
                "residual": int(marker["residual"]),
                "points": int(marker["points"]),
                **{flag.name.lower(): int(flag in Quality(int(marker["flags"]))) for flag in Quality},
            },
        }
        for marker in result.markers
    ]


def test_view(large_simulator):
    """Three frames; software reads each over the bus, and a viewer what it can in every clock."""
    random = np.random.default_rng(8)
    frames = [marker_grid(random, 48, 64, (28, 32)), marker_frame(48, 64, [(5, 9, 20, 90), (37, 20, 22, 0)])]
    frames.append(marker_frame(48, 64, [(20, 9, 30, 20)]))
    config = SensorConfig(width=SIZE[0], height=SIZE[1])
    pixels = np.concatenate([camera_pixels(frame).astype(np.int64) for frame in frames])
    verilog = emit.to_verilog(Sensor(config=config, has_view=True), emit.TOP)
    words, seen = play(large_simulator, SIZE, [(pixels, pauses(frames))], REFINING, verilog, view_seed=1)

    models = ModelSensor(*SIZE).run(frames)
    time = pixel_clocks(pixels, pauses(frames)) - 1
    firsts = [number * 48 * 64 for number in range(len(frames))]
    check(
        words,
        [
            encoded(number, models[number], int(time[first]), int(time[first + 48 * 64 - 1]))
            for number, first in enumerate(firsts)
        ],
    )
    signature = result_view(config)
    shapes = [signature.members[name].signature.members["data"].shape for name in ("blobs", "corners", "markers")]
    published = [
        {
            (index, len(kept), f"{shapes[which].const(item).as_bits():x}")
            for kept in (list(items(model))[which] for model in models)
            for index, item in enumerate(kept)
        }
        for which in range(3)
    ]
    given = [
        {(int(index), int(count), item) for which, index, count, item in seen if int(which) == k} for k in range(3)
    ]
    assert given == published  # Every item of every frame was seen, and nothing else.
