// Yosys makes a > b of a subtraction and a test for equality, but b < a of a subtraction alone.
(* techmap_celltype = "$gt $le" *)
module _swapped_comparison (A, B, Y);
    parameter A_SIGNED = 0;
    parameter B_SIGNED = 0;
    parameter A_WIDTH = 1;
    parameter B_WIDTH = 1;
    parameter Y_WIDTH = 1;
    parameter _TECHMAP_CELLTYPE_ = "";
    input [A_WIDTH-1:0] A;
    input [B_WIDTH-1:0] B;
    output [Y_WIDTH-1:0] Y;
    generate
        if (_TECHMAP_CELLTYPE_ == "$gt")
            \$lt #(.A_SIGNED(B_SIGNED), .B_SIGNED(A_SIGNED), .A_WIDTH(B_WIDTH), .B_WIDTH(A_WIDTH), .Y_WIDTH(Y_WIDTH))
                _TECHMAP_REPLACE_ (.A(B), .B(A), .Y(Y));
        else
            \$ge #(.A_SIGNED(B_SIGNED), .B_SIGNED(A_SIGNED), .A_WIDTH(B_WIDTH), .B_WIDTH(A_WIDTH), .Y_WIDTH(Y_WIDTH))
                _TECHMAP_REPLACE_ (.A(B), .B(A), .Y(Y));
    endgenerate
endmodule
