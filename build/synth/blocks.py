"""Which parts of the system are counted one by one, and what the paper and others have measured."""

import re

__all__ = ["KEPT", "PAPER", "VEXRISCV_LUTS", "block_name"]

#: Modules that stay apart: those right below the system and right below its sensor.
KEPT = (r"rasterpose_system\.[^.]+", r"rasterpose_system\.sensor\.[^.]+")

#: The paper's table 5: the whole system, by Quartus, with a Nios II.
PAPER = {"le": 10_814, "ff": 6_683, "memory_bits": 1_703_417, "mult9": 11}

#: LUTs that VexRiscv's own README gives for its "full" configuration (RV32IM, caches of 4 KB) on a Cyclone IV, by
#: Quartus. ``VexRiscv.v`` of pythondata-cpu-vexriscv is near to it, but not the same; no published pair is nearer.
VEXRISCV_LUTS = 2_407


def block_name(module):
    """``sensor.corners`` for ``rasterpose_system.sensor.corners$12``; what is in no block is ``wiring``."""
    _, _, name = re.sub(r"\$\d+$", "", module).partition(".")
    return name or "wiring"
