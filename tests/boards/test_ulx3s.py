"""The ULX3S in cocotb: pictures of an OV7670 that had to be set up, poses on the serial line, and DVI on a monitor."""

import json
import re

import numpy as np
import pytest

from build.ulx3s import bitstream
from firmware.layout import settings_bytes
from firmware.reference import Camera
from firmware.toolchain.images import build
from hdl.boards.ulx3s.pins import PINS, constraints
from hdl.boards.ulx3s.top import Ulx3s
from hdl.config import SensorConfig
from hdl.display.timing import VideoMode
from sim.models.dvi import DviMonitor
from sim.models.ov7670 import Ov7670Camera
from sim.models.rgb565 import as_received
from sim.models.vga import VgaMonitor
from tests.boards.board_bench import check_frame, emitted, expected_screen, simulate_board, told_lines
from tests.boards.tb_ulx3s import Op
from tests.shapes import marker_frame

COLUMNS, ROWS = 64, 48
CLOCK_HZ, DIVISOR = 2_000_000, 4
PERIOD_PS = 500_000
#: Of PCLK, whose two clocks a pixel are faster than the board's clock; no multiple of it.
PIXEL_PS = 403_170
PATIENCE = 250_000
CAMERA = Camera(80.0, 80.0, 31.5, 23.5)
MODE = VideoMode(columns=72, column_front=8, column_sync=16, column_back=104,
                 rows=50, row_front=1, row_sync=2, row_back=3)  # fmt: skip
#: Times ten bits in which there is a whole picture.
RECORDED = int(2.2 * MODE.total_columns * MODE.total_rows)


def play(simulator, program, pictures):
    image = build("sensor")
    settings = {name: getattr(CAMERA, name) for name in ("fx", "fy", "cx", "cy")}
    settings |= {"uart_divisor": DIVISOR, "tick_clocks": 20_000, "display_ticks": 0, "status_ticks": 0}
    words = image.patched("settings", settings_bytes(image, **settings)).words
    board = Ulx3s(
        config=SensorConfig(width=COLUMNS, height=ROWS), program=words.tolist(), mode=MODE, clock_hz=CLOCK_HZ,
        tick_us=50, start_clocks=200,
    )  # fmt: skip
    arrays = {
        "program": [(*step, 0, 0)[:3] for step in program],
        "period_ps": PERIOD_PS,
        "pixel_ps": PIXEL_PS,
        "divisor": DIVISOR,
        "blank": 40,
    }
    for number, picture in enumerate(pictures):
        arrays[f"picture.{number}"] = picture
    return simulate_board(board, "ulx3s", simulator, arrays, size=f"{COLUMNS}x{ROWS}")


def shown(cable):
    """Pictures that a monitor makes of what was received, ten bits of four channels at a time."""
    bits = (cable[:, None] >> np.arange(40, dtype=np.uint64) & np.uint64(1)).astype(np.uint8).reshape(-1, 4)
    channels = [bits[:, channel] for channel in range(4)]
    hsync, vsync, rgb, active = DviMonitor().receive(*channels)
    return VgaMonitor(MODE).pictures(hsync, vsync, rgb, active)


def test_from_camera_to_monitor(large_simulator):
    """With Verilator two pictures, the first before the camera is set up; with Icarus one, and nothing of the cable."""
    sent = [
        np.repeat(marker_frame(ROWS, COLUMNS, [place])[..., None], 3, axis=2)
        for place in ((20, 9, 30, 20), (12, 7, 33, 100))
    ]
    pictures = [as_received(picture) for picture in sent]
    is_long = large_simulator == "verilator"
    program = [(Op.PLAY, 0)] * is_long + [(Op.CAMERA, PATIENCE), (Op.LOOK,), (Op.LINES, 1, PATIENCE), (Op.PLAY, 0)]
    program += [(Op.LINES, 3, PATIENCE), (Op.LOOK,)]
    if is_long:
        program += [(Op.RECORD, RECORDED), (Op.PLAY, 1), (Op.LINES, 5, PATIENCE), (Op.RECORD, RECORDED)]
    captured = play(large_simulator, program, sent)
    camera = Ov7670Camera()
    camera.bus.writes.extend(map(tuple, captured["writes"].tolist()))
    assert camera.is_set_up
    told = told_lines(captured, PERIOD_PS // 1000, DIVISOR)
    check_frame(told[:2], 0, pictures[0], camera=CAMERA, clock_hz=CLOCK_HZ)
    before, after = captured["log"].tolist()
    assert before & 0b101111 == 0b000001 and after & 0b101111 == 0b100001
    if is_long:
        check_frame(told[2:], 1, pictures[1], camera=CAMERA, clock_hz=CLOCK_HZ)
        for cable, picture in zip(np.split(captured["cable"], 2), pictures, strict=True):
            for got in shown(cable):
                assert (got == expected_screen(picture, MODE)).all()


def test_pins():
    """Every port has balls and every ball one port; the constraints say so of each bit."""
    balls = [name for pins in PINS.values() for name in pins.names]
    assert len(balls) == len(set(balls))
    text = constraints()
    located = re.findall(r'LOCATE COMP "([^"]+)" SITE "([^"]+)";', text)
    assert [ball for _, ball in located] == balls
    assert sorted(re.findall(r'IOBUF PORT "([^"]+)" [^;]*IO_TYPE=\w+', text)) == sorted(bit for bit, _ in located)
    header = re.search(r"^module ulx3s\((.*?)\);", emitted("ulx3s"), re.MULTILINE | re.DOTALL)[1]
    assert sorted(re.findall(r"\w+", header)) == sorted(PINS)


#: A net has many names, and nextpnr's report any of them.
NETLIST = {
    "modules": {
        "EHXPLLL": {"attributes": {"blackbox": 1}},
        "rasterpose_ulx3s": {
            "attributes": {"top": 1},
            "cells": {
                "clocks.pll_video": {"type": "EHXPLLL", "connections": {"CLKOP": [8], "CLKOS": [29]}},
                "clocks.pll_system": {"type": "EHXPLLL", "connections": {"CLKOP": [34]}},
                "other": {"type": "TRELLIS_FF", "connections": {"CLK": [34]}},
            },
            "netnames": {
                "clocks.shift": {"bits": [8]},
                "cam_xclk": {"bits": [29]},
                "camera.crossing.clk": {"bits": [34]},
                "system$110.clk": {"bits": [34]},
                "led": {"bits": ["0", 7]},
                "cam_pclk": {"bits": [2]},
            },
        },
    }
}
REPORT = {
    "fmax": {
        "$glbnet$system$110.clk": {"achieved": 61.239, "constraint": 60.0},
        "$glbnet$cam_xclk$TRELLIS_IO_OUT": {"achieved": 101.7, "constraint": 25.0},
        "$glbnet$cam_pclk$TRELLIS_IO_IN": {"achieved": 24.9, "constraint": 25.0},
    },
    "utilization": {"TRELLIS_COMB": {"used": 30000, "available": 83640}, "EXTREFB": {"used": 0, "available": 2}},
}


def test_report():
    names = bitstream.clock_names(NETLIST)
    assert names == {
        "clocks.shift": "shift", "cam_xclk": "pixel", "camera.crossing.clk": "system", "system$110.clk": "system",
    }  # fmt: skip
    result = bitstream.read_report(REPORT, 7, names)
    assert result.clocks == {"system": (61.24, 40.0), "pixel": (101.7, 25.0), "cam_pclk": (24.9, 25.0)}
    assert result.cells == {"TRELLIS_COMB": (30000, 83640)} and result.missed == ["cam_pclk"]


def test_timing_that_is_not_met(monkeypatch, tmp_path):
    """All seeds are tried, and then there is no bitstream, but a message."""
    tried = []
    monkeypatch.setattr(bitstream, "_write_sources", lambda folder: None)
    monkeypatch.setattr(
        bitstream, "netlist", lambda name, files, folder: (folder / f"{name}.json").write_text(json.dumps(NETLIST))
    )
    monkeypatch.setattr(
        bitstream,
        "_place",
        lambda folder, seed, names: tried.append(seed) or bitstream.read_report(REPORT, seed, names),
    )
    monkeypatch.setattr(bitstream.tools, "ecppack", lambda *arguments: pytest.fail("must not be called"))
    with pytest.raises(
        bitstream.TimingError, match=r"not met with seeds 1, 2, 3; at best: cam_pclk 24\.9 MHz instead of 25"
    ):
        bitstream.make(tmp_path)
    assert tried == [1, 2, 3]
    aim = (tmp_path / f"{bitstream.NAME}.aim.lpf").read_text()
    assert re.fullmatch(r'FREQUENCY NET "(camera\.crossing|system\$110)\.clk" 56 MHZ;\n', aim)
