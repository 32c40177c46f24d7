// What Lattice's EHXPLLL does for the ULX3S, for simulation: its oscillator's input is driven FASTER times as fast as the
// real one, and each output is the fraction of it that its parameters say, all in phase, with edges at the input's;
// locked after 256 of its clocks. What it cannot do gives a clock that never moves.
module EHXPLLL #(
    parameter PLLRST_ENA = "", INTFB_WAKE = "", STDBY_ENABLE = "", DPHASE_SOURCE = "", FEEDBK_PATH = "",
    parameter OUTDIVIDER_MUXA = "", OUTDIVIDER_MUXB = "", OUTDIVIDER_MUXC = "", OUTDIVIDER_MUXD = "",
    parameter CLKI_DIV = 1, CLKFB_DIV = 1,
    parameter CLKOP_ENABLE = "", CLKOS_ENABLE = "",
    parameter CLKOP_DIV = 1, CLKOS_DIV = 1,
    parameter CLKOP_CPHASE = 0, CLKOS_CPHASE = 0,
    parameter CLKOP_FPHASE = 0, CLKOS_FPHASE = 0
) (
    input  CLKI,
    input  CLKFB,
    input  RST,
    input  STDBY,
    input  PHASESEL0,
    input  PHASESEL1,
    input  PHASEDIR,
    input  PHASESTEP,
    input  PHASELOADREG,
    input  PLLWAKESYNC,
    input  ENCLKOP,
    output CLKOP,
    output CLKOS,
    output LOCK
);
    localparam FASTER = 20;
    localparam HAS_OS = CLKOS_ENABLE == "ENABLED";
    localparam IN_PHASE = !HAS_OS || CLKOP_CPHASE == CLKOS_CPHASE;
    localparam INNER = IN_PHASE ? CLKFB_DIV * CLKOP_DIV : 0;

    fraction #(.FACTOR(INNER), .DIVISOR(FASTER * CLKI_DIV * CLKOP_DIV)) op (.in(CLKI), .out(CLKOP));
    fraction #(.FACTOR(HAS_OS ? INNER : 0), .DIVISOR(FASTER * CLKI_DIV * CLKOS_DIV)) os (.in(CLKI), .out(CLKOS));

    reg [8:0] count = 0;
    always @(posedge CLKI) if (!LOCK) count <= count + 9'd1;
    assign LOCK = count[8];
endmodule

// FACTOR / DIVISOR clocks a clock, which is half a clock at most.
module fraction #(parameter FACTOR = 1, parameter DIVISOR = 2) (input in, output reg out);
    reg  [31:0] sum = 0;
    wire [31:0] next = sum + 2 * FACTOR;
    initial out = 0;
    always @(posedge in) begin
        sum <= next;
        if (next >= DIVISOR) begin
            sum <= next - DIVISOR;
            out <= !out;
        end
    end
endmodule
