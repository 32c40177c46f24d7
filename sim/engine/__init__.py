"""Any block as fast as a PC can run it: its emitted Verilog, compiled by Verilator, behind one Python class.

>>> from sim.engine import StreamEngine, fields, pack
>>> from hdl.pixels import GreyPixel, BinaryPixel
>>> engine = StreamEngine("threshold", 640, 480)
>>> beats = pack(GreyPixel, level=[10, 20], first=[1, 0], eol=[0, 1], last=[0, 1])
>>> run = engine.run({"i": (beats, None)}, {"level": 15, "bright": 0})
>>> fields(run["o"], BinaryPixel)["foreground"], run["o"].clock
(array([1, 0]), array([1, 2]))

See :class:`~sim.engine.stream.StreamEngine` for what the streams, settings and clocks mean, and
``tests/hdl/harness.py`` for the same run in cocotb.
"""

from sim.engine.build import EngineError
from sim.engine.packing import fields, pack
from sim.engine.plan import Captured, Run, random_idle
from sim.engine.stream import StreamEngine

__all__ = ["Captured", "EngineError", "Run", "StreamEngine", "fields", "pack", "random_idle"]
