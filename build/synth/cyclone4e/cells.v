// The cells of Cyclone IV that are counted, as black boxes: a memory block, a logic element in arithmetic mode (one bit of
// a carry chain), and the embedded multiplier as a whole (two 9-bit elements) or as one of its halves.
(* blackbox *) module M9K #(parameter W = 36, R = 36) (
    input clk, we, input [12:0] wa, input [W-1:0] wd, input re, input [12:0] ra, output [R-1:0] rd
);
endmodule
(* blackbox *) module CARRYLE #(parameter INVERT_B = 0) (input a, b, ci, output s, co);
endmodule
(* blackbox *) module MULT18 #(
    parameter A_WIDTH = 18, B_WIDTH = 18, Y_WIDTH = 36, A_SIGNED = 0, B_SIGNED = 0
) (input [A_WIDTH-1:0] A, input [B_WIDTH-1:0] B, output [Y_WIDTH-1:0] Y);
endmodule
(* blackbox *) module MULT9 #(
    parameter A_WIDTH = 9, B_WIDTH = 9, Y_WIDTH = 18, A_SIGNED = 0, B_SIGNED = 0
) (input [A_WIDTH-1:0] A, input [B_WIDTH-1:0] B, output [Y_WIDTH-1:0] Y);
endmodule
