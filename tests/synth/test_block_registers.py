"""Registers that block RAMs and multipliers of the ECP5 take in, and those that they must leave."""

import json

import pytest

from build.synth.ecp5 import netlist

HEAD = """
module block (input clk, rst, en, input [9:0] at, from, input [17:0] d, input [8:0] a, b,
              output [17:0] q, output [17:0] product);
    (* no_rw_check *) reg [17:0] words [0:1023];
    reg [17:0] fetched, kept, result;
    reg [8:0] first, second;
    always @(posedge clk) if (en) words[at] <= d;
"""
PLAIN = "always @(posedge clk) begin fetched <= words[from]; kept <= fetched; end assign q = kept;"
READING = {
    "plain": (PLAIN, "OUTREG"),
    "enabled alike": ("always @(posedge clk) if (rst) begin fetched <= words[from]; kept <= fetched; end "
                      "assign q = kept;", "OUTREG"),
    "enabled otherwise": ("always @(posedge clk) begin if (rst) fetched <= words[from]; if (en) kept <= fetched; end "
                          "assign q = kept;", "NOREG"),
    "with reset": ("always @(posedge clk) begin fetched <= words[from]; kept <= rst ? 0 : fetched; end "
                   "assign q = kept;", "NOREG"),
    "used before as well": ("always @(posedge clk) begin fetched <= words[from]; kept <= fetched; end "
                            "assign q = kept ^ fetched;", "NOREG"),
    "not at once": ("always @(posedge clk) begin fetched <= words[from]; kept <= ~fetched; end assign q = kept;",
                    "NOREG"),
}  # fmt: skip


def cells(tmp_path, body):
    (tmp_path / "block.v").write_text(f"{HEAD}{body}\nendmodule\n")
    netlist("block", ["block.v"], tmp_path)
    return json.loads((tmp_path / "block.json").read_text())["modules"]["block"]["cells"].values()


@pytest.mark.parametrize("name", READING)
def test_block_ram(tmp_path, name):
    body, mode = READING[name]
    found = cells(tmp_path, f"{body} assign product = 0;")
    (memory,) = (cell for cell in found if cell["type"] == "DP16KD")
    modes = {memory["parameters"][f"REGMODE_{side}"] for side in "AB"}
    assert (mode in modes) and (mode == "OUTREG" or modes == {"NOREG"})
    registers = sum(cell["type"] == "TRELLIS_FF" for cell in found)
    assert registers == (0 if mode == "OUTREG" else 18)


def multiplier(tmp_path, first):
    """A multiplier between registers, of which one factor's is ``first``, and the number of those outside of it."""
    found = cells(
        tmp_path,
        f"always @(posedge clk) begin first <= {first}; second <= b; result <= first * second; kept <= second; end "
        "assign product = result; assign q = kept;",
    )
    (block,) = (cell for cell in found if cell["type"] == "MULT18X18D")
    return block["parameters"], sum(cell["type"] == "TRELLIS_FF" for cell in found)


def test_multiplier(tmp_path):
    """Factors and product are registered in it; a factor that is used elsewhere has a register there as well."""
    parameters, outside = multiplier(tmp_path, "a")
    assert {parameters[f"REG_{place}_CLK"] for place in ("INPUTA", "INPUTB", "OUTPUT")} == {"CLK0"}
    assert outside == 18  # ``second`` and ``kept``


def test_multiplier_with_reset(tmp_path):
    """A factor whose register has a reset keeps both factors' outside."""
    parameters, outside = multiplier(tmp_path, "rst ? 0 : a")
    assert parameters["REG_OUTPUT_CLK"] == "CLK0" and "REG_INPUTA_CLK" not in parameters
    assert outside == 27
