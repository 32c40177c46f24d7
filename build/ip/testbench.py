"""What the Verilog testbench of the package plays: a rendered frame, and the words that the model finds in it."""

import pathlib

from hdl.emit import AVALON
from hdl.regs.bus import READ_LATENCY
from hdl.regs.map import avalon_maps
from sim.engine.frames import marker_words
from sim.models.avalon_video_input import control_packet, video_packet
from sim.models.sensor import ModelSensor
from sim.scene import random_marker_scene, render

__all__ = ["SCENE", "testbench"]

#: Columns and rows of the frame, small because Icarus makes few clocks of a sensor in a second.
SCENE = 64, 48

_WRITE, _EXPECT, _SEND = range(3)
#: Clocks in which one marker is matched and published, with plenty to spare.
_PATIENCE = 5000


def _transfers(config, result, columns, rows):
    """(operation, address or clocks, value) of everything that software does."""
    maps = avalon_maps(config)
    sensor = {entry.name: entry.offset for entry in (*maps["sensor"][1].registers, *maps["sensor"][1].windows)}
    base, inputs = maps["video_input"]
    size = columns | rows << 16
    published = 1 << maps["sensor"][1].register("irq_enable").field("published").low
    return [
        (_EXPECT, sensor["id"], maps["sensor"][1].register("id").field("magic").reset),
        (_WRITE, sensor["frame_size"], size),
        (_WRITE, sensor["irq_enable"], published),
        (_SEND, _PATIENCE, 0),
        (_EXPECT, base + inputs.register("video_size").offset, size),
        (_EXPECT, base + inputs.register("packet_errors").offset, 0),
        (_EXPECT, sensor["frames_complete"], 1),
        (_EXPECT, sensor["markers"], len(result.markers)),
        *(
            (_EXPECT, sensor["marker_window"] + 4 * place, word)
            for place, word in enumerate(marker_words(result.markers[0]))
        ),
    ]


def testbench(config):
    """File name -> text of the testbench for a :class:`~hdl.config.SensorConfig`.

    Raises
    ------
    ValueError
        If the sensor's largest frame is less than :data:`SCENE`.
    """
    columns, rows = SCENE
    if config.width < columns or config.height < rows:
        raise ValueError(
            f"the package needs a sensor for frames of {columns} x {rows} pixels or more, "
            f"not {config.width} x {config.height}"
        )
    frame = render(random_marker_scene(1, columns, rows, side_px=(22, 24), tilt_deg=(0, 20))).image
    (result,) = ModelSensor(config.width, config.height).run([frame])
    beats = control_packet(columns, rows) + video_packet(frame)
    transfers = _transfers(config, result, columns, rows)
    return {
        f"{AVALON}_tb.v": pathlib.Path(__file__).with_name(f"{AVALON}_tb.v").read_text(),
        "scene.vh": f"`define BEATS {len(beats)}\n`define TRANSFERS {len(transfers)}\n"
        f"`define READ_LATENCY {READ_LATENCY}\n",
        "beats.hex": "".join(f"{end << 25 | start << 24 | data:07x}\n" for data, start, end in beats),
        "transfers.hex": "".join(" ".join(f"{word:08x}" for word in transfer) + "\n" for transfer in transfers),
    }
