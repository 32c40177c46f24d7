"""A design behind registers: what is placed and routed has three pins, and every path begins and ends in a register.

Else pins would bound the design's size, and paths from and to them its speed.
"""

import json

from build.tools import yosys

__all__ = ["ports_of", "shell"]

#: Outputs that are joined in one clock.
_JOINED = 16


def ports_of(top, files, folder):
    """``[(name, direction, width)]`` of a module, by Yosys."""
    yosys(
        f"read_verilog {' '.join(files)}\nhierarchy -top {top}\nselect {top}\nproc\nwrite_json -selected ports.json\n",
        folder,
        "ports.log",
    )
    module = json.loads((folder / "ports.json").read_text())["modules"][top]
    return [(name, port["direction"], len(port["bits"])) for name, port in module["ports"].items()]


def shell(top, ports):
    """Verilog of a module ``shell``: inputs of ``top`` come from one shift register, outputs go into one bit."""
    inputs = [(name, width) for name, direction, width in ports if direction == "input" and name != "clk"]
    outputs = [(name, width) for name, direction, width in ports if direction == "output"]
    if any(direction not in ("input", "output") for _, direction, _ in ports):
        raise ValueError(f"{top} has a port that goes both ways")
    n_in, n_out = (sum(width for _, width in some) for some in (inputs, outputs))
    groups = -(-n_out // _JOINED)
    connections, at = [".clk(clk)"], {"i": 0, "o": 0}
    for bus, some in (("i", inputs), ("o", outputs)):
        for name, width in some:
            connections.append(f".{name}({bus}[{at[bus]} +: {width}])")
            at[bus] += width
    return "\n".join(
        [
            "module shell (input clk, input serial_in, output reg serial_out);",
            f"    reg [{n_in - 1}:0] i;",
            f"    wire [{n_out - 1}:0] o;",
            f"    reg [{groups * _JOINED - 1}:0] kept;",
            f"    reg [{groups - 1}:0] joined;",
            "    integer k;",
            "    always @(posedge clk) begin",
            f"        i <= {{i[{n_in - 2}:0], serial_in}};",
            "        kept <= o;",
            f"        for (k = 0; k < {groups}; k = k + 1) joined[k] <= ^kept[k * {_JOINED} +: {_JOINED}];",
            "        serial_out <= ^joined;",
            "    end",
            f"    {top} dut ({', '.join(connections)});",
            "endmodule",
            "",
        ]
    )
