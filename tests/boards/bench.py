"""What the testbenches of all boards have: the camera's two-wire bus, and somebody at the serial line.

It runs inside the simulator.
"""

from cocotb.triggers import FallingEdge, First, Timer
from cocotb.utils import get_sim_time

__all__ = ["BoardBench"]


class BoardBench:
    """A board with pins ``scl``, ``sda`` and ``txd``, and a ``camera`` model that has a ``bus``.

    Parameters
    ----------
    period_ps : int
        Of the system's clock.
    divisor : int
        Clocks of a bit of the serial line.
    """

    def __init__(self, dut, camera, *, period_ps, divisor):
        self.dut, self.camera = dut, camera
        self.period_ps, self._bit_ps = period_ps, period_ps * divisor
        self.line, self.lines = [(0, 1)], 0  #: (ns, level) of the line's changes; lines that have ended
        self.log = []

    async def clocks(self, count):
        """Let so many of the system's clocks go by."""
        await Timer(self.period_ps * count, unit="ps")

    async def until(self, reached, patience):
        """Wait until it is reached, for so many clocks at most."""
        for _ in range(0, patience, 50):
            if reached():
                return
            await self.clocks(50)

    async def bus(self):
        """The two-wire bus, whose lines the simulator resolves."""
        dut, slave = self.dut, self.camera.bus
        while True:
            slave.lines(round(get_sim_time("ns")), int(dut.scl.value), int(dut.sda.value))
            dut.sda_pulled.value = int(slave.pulls_sda)
            await First(dut.scl.value_change, dut.sda.value_change)
            await self.clocks(1)

    async def listen(self):
        """The serial line's changes."""
        txd = self.dut.txd
        while True:
            await txd.value_change
            self.line.append((round(get_sim_time("ns")), int(txd.value)))

    async def count_lines(self):
        """Ends of lines, from bytes that are sampled in the middle of their bits."""
        txd, bit, half = self.dut.txd, Timer(self._bit_ps, unit="ps"), Timer(self._bit_ps // 2, unit="ps")
        while True:
            await FallingEdge(txd)
            await half
            byte = 0
            for k in range(8):
                await bit
                byte |= int(txd.value) << k
            await bit
            self.lines += byte == ord("\n")

    async def finish(self):
        """Until the stop bit of a line that was just counted is over."""
        await Timer(self._bit_ps, unit="ps")
