"""Emitted Verilog in which a read that meets a write returns garbage, where the hardware promised not to care."""

import re

__all__ = ["collided", "promised"]

_MEMORY = r"^  \(\* no_rw_check = 32'd1 \*\)\n  reg (?:\[[^]]*\] )?(\S+) +\[\d+:\d+\];"
_WRITE = r"    if \((?P<enable>[^\n]+)\)\n      {name} ?\[(?P<at>[^\n]+)\] <= "
_READ = r"(?P<to>_\d+_) <= {name} ?\[(?P<at>[^\n]+)\];"


def promised(verilog):
    """Names of the memories that have :data:`hdl.memories.NO_COLLISIONS`."""
    return re.findall(_MEMORY, verilog, re.MULTILINE)


def collided(verilog):
    """``verilog`` with the complement of the word at each such collision.

    Raises
    ------
    ValueError
        If a memory is not written and read as Amaranth writes it.
    """
    modules = re.split(r"(?<=^endmodule)", verilog, flags=re.MULTILINE)
    return "".join(_collided_module(module) for module in modules)


def _collided_module(text):
    for memory in re.findall(_MEMORY, text, re.MULTILINE):
        name = re.escape(memory)
        writes = list(re.finditer(_WRITE.format(name=name), text))
        reads = re.findall(_READ.format(name=name), text)
        if len(writes) != 1 or len(reads) != 1:
            raise ValueError(f"{memory} has {len(writes)} writes and {len(reads)} reads")
        enable, written = writes[0]["enable"], writes[0]["at"]

        def read(match, memory=memory, enable=enable, written=written):
            at = match["at"]
            meets = f"({enable}) && ({written}) == ({at})"
            return f"{match['to']} <= {meets} ? ~{memory} [{at}] : {memory} [{at}];"

        text = re.sub(_READ.format(name=name), read, text)
    return text
