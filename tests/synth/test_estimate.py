"""The mapping itself, on a design whose logic elements can be told by hand."""

import pytest

from build.synth.cyclone4e.estimate import estimate
from build.tools import ToolError

DESIGN = """
module small (input clk, en, input [7:0] a, b, output reg [7:0] q, output reg less, output reg [35:0] read,
              output reg [17:0] product);
    reg [35:0] words [0:255];
    reg [35:0] fetched;
    always @(posedge clk) begin
        if (en) q <= q + a;
        less <= a > b;
        if (en) words[a] <= {a, b, a, b, a[3:0]};
        fetched <= words[b];
        read <= fetched;
        product <= {a, 1'b1} * {b, 1'b1};
    end
endmodule
"""


def test_small_design(tmp_path):
    area = estimate("small", {"small.v": DESIGN}, tmp_path)["small"]
    # A sum of 8 bits with its register, a comparison of 8 bits without a test for equality.
    assert area.carry == 16 and area.lut <= 2
    # The registers behind memory and multiplier are theirs.
    assert area.alone <= 1 and area.le <= 18
    assert (area.m9k, area.memory_bits, area.mult9) == (1, 9216, 1)


def test_what_is_no_verilog(tmp_path):
    with pytest.raises(ToolError, match=r"^yosys failed, see .*bad\.log: .*ERROR"):
        estimate("bad", {"bad.v": "module bad (\n"}, tmp_path)
