"""The processor: VexRiscv, a RISC-V core in Verilog that comes with ``pythondata-cpu-vexriscv``.

RV32IM in machine mode with 4 KB caches for instructions and for data, lines of 32 bytes, written through;
addresses from :data:`UNCACHED` on are not cached. Its port for custom functions (CFU) carries the instructions
of opcode custom-0 and works once bit 31 of CSR 0xBC0 is set; the other bits of that CSR enable
:attr:`Cpu.interrupts`. Execution starts at address 0. The core takes no bus errors.

Licence of the core: MIT, :func:`cpu_licence`. Its text is :func:`cpu_verilog`, module ``VexRiscv``.
"""

import pathlib

import pythondata_cpu_vexriscv
from amaranth import Cat, ClockSignal, Const, Instance, Module, ResetSignal, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from hdl.system.memory_bus import MemoryBus

__all__ = ["INTERRUPTS", "UNCACHED", "CfuCommand", "Cpu", "cpu_licence", "cpu_verilog"]

#: Lines of :attr:`Cpu.interrupts`.
INTERRUPTS = 2

#: From this byte address on loads and stores bypass the data cache.
UNCACHED = 0x8000_0000

#: A custom function: {funct7, funct3} of the instruction, and what its registers rs1 and rs2 hold.
CfuCommand = data.StructLayout({"function": 10, "a": 32, "b": 32})

_BURST = 0b010  # Wishbone's CTI: an incrementing burst that goes on after this word


def cpu_verilog():
    """Verilog of the core: the modules VexRiscv, InstructionCache and DataCache."""
    return pathlib.Path(pythondata_cpu_vexriscv.data_location, "VexRiscv_FullCfu.v").read_text()


def cpu_licence():
    """Licence of that Verilog, which copies of it must carry."""
    return pathlib.Path(pythondata_cpu_vexriscv.data_location, "ext", "VexRiscv", "LICENSE").read_text()


class Cpu(wiring.Component):
    """The core with its buses as :class:`~hdl.system.memory_bus.MemoryBus`.

    Members
    -------
    instructions, data : :py:`Out(MemoryBus())`
        Fetches, in lines; loads and stores.
    command : :py:`Out(stream.Signature(CfuCommand))`
        A custom function: at most one without its response.
    response : :py:`In(stream.Signature(32))`
        Its result.
    interrupts : :py:`In(INTERRUPTS)`
        Levels; the number of a line is that of its bit in the CSRs 0xBC0 and 0xFC0.
    timer : :py:`In(1)`
        The machine timer interrupt, a level.
    reset : :py:`In(1)`
        Start anew. What the buses and the port have not answered then must not be answered later.
    """

    instructions: Out(MemoryBus())
    data: Out(MemoryBus())
    command: Out(stream.Signature(CfuCommand))
    response: In(stream.Signature(32))
    interrupts: In(INTERRUPTS)
    timer: In(1)
    reset: In(1)

    def elaborate(self, platform):
        m = Module()
        m.submodules.core = Instance(
            "VexRiscv",
            i_clk=ClockSignal(),
            i_reset=ResetSignal() | self.reset,
            i_externalResetVector=Const(0, 32),
            i_timerInterrupt=self.timer,
            i_softwareInterrupt=0,
            i_externalInterruptArray=Cat(self.interrupts, Const(0, 32 - INTERRUPTS)),
            o_CfuPlugin_bus_cmd_valid=self.command.valid,
            i_CfuPlugin_bus_cmd_ready=self.command.ready,
            o_CfuPlugin_bus_cmd_payload_function_id=self.command.payload.function,
            o_CfuPlugin_bus_cmd_payload_inputs_0=self.command.payload.a,
            o_CfuPlugin_bus_cmd_payload_inputs_1=self.command.payload.b,
            i_CfuPlugin_bus_rsp_valid=self.response.valid,
            o_CfuPlugin_bus_rsp_ready=self.response.ready,
            i_CfuPlugin_bus_rsp_payload_outputs_0=self.response.payload,
            **self._wishbone(m, "iBus", self.instructions),
            **self._wishbone(m, "dBus", self.data),
        )
        return m

    @staticmethod
    def _wishbone(m, name, bus):
        """Ports of one of the core's buses. CYC is STB, and the core makes no linear wraps (BTE)."""
        cti = Signal(3, name=f"{name}_cti")
        m.d.comb += bus.burst.eq((cti == _BURST) & ~bus.write)
        ports = {
            "o_{}_STB": bus.valid,
            "o_{}_WE": bus.write,
            "o_{}_ADR": bus.address,
            "o_{}_SEL": bus.select,
            "o_{}_DAT_MOSI": bus.write_data,
            "o_{}_CTI": cti,
            "i_{}_ACK": bus.ack,
            "i_{}_DAT_MISO": bus.read_data,
            "i_{}_ERR": 0,
            "o_{}_CYC": Signal(name=f"{name}_cyc"),
            "o_{}_BTE": Signal(2, name=f"{name}_bte"),
        }
        return {port.format(f"{name}Wishbone"): value for port, value in ports.items()}
