"""Logic elements, registers, memory blocks and multipliers on Cyclone IV E: an estimate by Yosys.

Yosys's own ``synth_intel`` gives two to three times what Quartus does: it uses neither carry chains nor multipliers. So
map.ys maps to the device's cells itself: one logic element a bit of a carry chain, LUTs of four inputs, M9K blocks in
simple dual-port mode, 9-bit multiplier elements, registers with enable and synchronous clear.
"""

import pathlib
import re
import shutil

from build.synth.count import Area, count
from build.tools import yosys

__all__ = ["estimate"]

_HERE = pathlib.Path(__file__).parent
_CELLS = ("cells.v", "m9k.txt", "m9k_map.v", "alu_map.v")


def estimate(top, sources, folder, blocks=()):
    """Areas of a design.

    Parameters
    ----------
    top : str
        Its top module.
    sources : dict
        File name -> Verilog.
    folder : path
        Where to work: it is made, and keeps the logs.
    blocks : sequence of str
        Regular expressions for the modules that are counted one by one, each with all that is in it.

    Returns
    -------
    dict
        Module name -> :class:`~build.synth.count.Area`; the top module has what is in none of ``blocks``.

    Raises
    ------
    ToolError
        If Yosys fails.
    """
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in sources.items():
        (folder / name).write_text(text)
    for name in _CELLS:
        shutil.copy(_HERE / name, folder / name)
    shutil.copy(_HERE.parent / "order_map.v", folder)
    names = re.findall(r"^module (\\\S+|\w+)", "\n".join(sources.values()), re.MULTILINE)
    kept = [name for name in names if any(re.fullmatch(block, name.lstrip("\\")) for block in blocks)]
    script = (_HERE / "map.ys").read_text()
    for key, value in {"files": " ".join(sources), "top": top, "blocks": " ".join(kept) or "w:none"}.items():
        script = script.replace(f"{{{key}}}", value)
    yosys(script, folder, log=f"{top}.log")
    areas = count(folder / f"{top}.netlist.json", folder / f"{top}.memories.json")
    return {name.lstrip("\\"): area for name, area in areas.items() if area != Area()}
