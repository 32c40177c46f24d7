"""Place and route for an ECP5-85 of speed grade 6, by Yosys and nextpnr: LUTs, block RAMs and clock speed."""

import json
import pathlib
import re
import shutil

from build.synth.block_registers import pack_block_registers
from build.synth.harness import ports_of, shell
from build.tools import nextpnr_ecp5, yosys

__all__ = ["PART", "ROUTER", "netlist", "place_and_route"]

_HERE = pathlib.Path(__file__).parent

#: LFE5U-85F-6BG381C, that of the ULX3S.
PART = ("--85k", "--package", "CABGA381", "--speed", "6")

#: nextpnr's other router takes ten times as long for designs of this size.
ROUTER = ("--router", "router2")


def netlist(top, files, folder):
    """Map the Verilog ``files`` in ``folder`` to the chip's cells: ``TOP.json``."""
    shutil.copy(_HERE / "order_map.v", folder)
    passes = (
        # Boards instantiate the vendor's cells, so these are read before and not by synth_ecp5.
        "read_verilog -lib -specify +/ecp5/cells_sim.v +/ecp5/cells_bb.v",
        f"read_verilog {' '.join(files)}",
        f"hierarchy -check -top {top}",
        "proc",
        "techmap -map order_map.v",
        f"synth_ecp5 -top {top} -run coarse: -json {top}.json",
    )
    yosys("\n".join(passes) + "\n", folder)
    file = pathlib.Path(folder, f"{top}.json")
    cells = json.loads(file.read_text())
    pack_block_registers(cells)
    file.write_text(json.dumps(cells))


def place_and_route(top, sources, folder, *, target_mhz, timing_weight, seed=1):
    """Speed and size of a design behind registers.

    Parameters
    ----------
    top : str
        Its top module, with a clock ``clk``.
    sources : dict
        File name -> Verilog.
    folder : path
        Where to work: it is made, and keeps the logs.
    target_mhz : float
        What nextpnr strives for; to miss it is no error.
    timing_weight : int
        How much the placer cares for slow paths; 10 is its own default. With more, block RAMs stay nearer, but a full
        design may be so dense that no way is found through it.
    seed : int
        Of the placement: another one gives a few per cent more or less.

    Returns
    -------
    dict
        ``fmax_mhz``, ``lut`` (with carry bits, as nextpnr counts: TRELLIS_COMB), ``ff``, ``bram``, ``mult18``, and
        ``critical_path``: the cells of the slowest path with the nanoseconds until each.

    Raises
    ------
    ToolError
        If a tool fails.
    """
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in sources.items():
        (folder / name).write_text(text)
    (folder / "shell.v").write_text(shell(top, ports_of(top, sources, folder)))
    netlist("shell", [*sources, "shell.v"], folder)
    nextpnr_ecp5(
        [
            *(*PART, *ROUTER, "--json", "shell.json", "--report", "report.json", "--freq", target_mhz, "--seed", seed),
            *("--timing-allow-fail", "--lpf-allow-unconstrained", "--placer-heap-timingweight", timing_weight),
        ],
        folder,
    )
    return _read(json.loads((folder / "report.json").read_text()))


def _read(report):
    used = {kind: number["used"] for kind, number in report["utilization"].items()}
    ((_, clock),) = report["fmax"].items()
    return {
        "fmax_mhz": round(clock["achieved"], 2),
        "lut": used["TRELLIS_COMB"],
        "ff": used["TRELLIS_FF"],
        "bram": used["DP16KD"],
        "mult18": used["MULT18X18D"],
        "critical_path": _critical(report["critical_paths"]),
    }


def _critical(paths):
    """``[[nanoseconds, cell], ...]`` of the slowest path from register to register."""
    path = next(path for path in paths if re.match("posedge", path["from"]) and re.match("posedge", path["to"]))
    cells, time = [], 0.0
    for step in path["path"]:
        time += step["delay"]
        cells.append([round(time, 2), step["to"]["cell"]])
    return cells
