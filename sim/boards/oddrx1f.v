// What Lattice's ODDRX1F does, for simulation: of the two bits that were taken when the clock rose, D0 while it is high
// and D1 while it is low.
module ODDRX1F (
    input  D0,
    input  D1,
    input  SCLK,
    input  RST,
    output Q
);
    reg first = 0, second = 0;
    always @(posedge SCLK) begin
        first <= D0 & !RST;
        second <= D1 & !RST;
    end
    assign Q = SCLK ? first : second;
endmodule
