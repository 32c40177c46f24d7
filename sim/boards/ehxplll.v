// What Lattice's EHXPLLL does for the ULX3S, for simulation: its oscillator's input is driven with what the PLL itself
// would run at, (CLKFB_DIV * CLKOP_DIV) times as fast, and its outputs are that divided by even numbers, all in phase;
// locked after 256 of its clocks. What it cannot do gives a clock that never moves.
module EHXPLLL #(
    parameter PLLRST_ENA = "", INTFB_WAKE = "", STDBY_ENABLE = "", DPHASE_SOURCE = "", FEEDBK_PATH = "",
    parameter OUTDIVIDER_MUXA = "", OUTDIVIDER_MUXB = "", OUTDIVIDER_MUXC = "", OUTDIVIDER_MUXD = "",
    parameter CLKI_DIV = 1, CLKFB_DIV = 1,
    parameter CLKOP_ENABLE = "", CLKOS_ENABLE = "", CLKOS2_ENABLE = "",
    parameter CLKOP_DIV = 1, CLKOS_DIV = 1, CLKOS2_DIV = 1,
    parameter CLKOP_CPHASE = 0, CLKOS_CPHASE = 0, CLKOS2_CPHASE = 0,
    parameter CLKOP_FPHASE = 0, CLKOS_FPHASE = 0, CLKOS2_FPHASE = 0
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
    output CLKOS2,
    output LOCK
);
    localparam IN_PHASE = CLKI_DIV == 1 && CLKOP_CPHASE == CLKOS_CPHASE && CLKOP_CPHASE == CLKOS2_CPHASE;

    even_divider #(.DIVISOR(IN_PHASE ? CLKOP_DIV : 0)) divider_op (.in(CLKI), .out(CLKOP));
    even_divider #(.DIVISOR(IN_PHASE ? CLKOS_DIV : 0)) divider_os (.in(CLKI), .out(CLKOS));
    even_divider #(.DIVISOR(IN_PHASE ? CLKOS2_DIV : 0)) divider_os2 (.in(CLKI), .out(CLKOS2));

    reg [8:0] count = 0;
    always @(posedge CLKI) if (!LOCK) count <= count + 9'd1;
    assign LOCK = count[8];
endmodule

module even_divider #(parameter DIVISOR = 2) (input in, output reg out);
    reg [15:0] count = 0;
    initial out = 0;
    always @(posedge in) if (DIVISOR > 0 && DIVISOR % 2 == 0) begin
        count <= count + 16'd1;
        if (count == DIVISOR / 2 - 1) begin
            count <= 0;
            out <= !out;
        end
    end
endmodule
