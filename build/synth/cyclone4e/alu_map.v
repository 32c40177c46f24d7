// Sums, differences and comparisons on carry chains: one logic element a bit.
(* techmap_celltype = "$alu" *)
module _carry_chain (A, B, CI, BI, X, Y, CO);
    parameter A_SIGNED = 0;
    parameter B_SIGNED = 0;
    parameter A_WIDTH = 1;
    parameter B_WIDTH = 1;
    parameter Y_WIDTH = 1;
    parameter _TECHMAP_CONSTMSK_BI_ = 0;
    parameter _TECHMAP_CONSTVAL_BI_ = 0;
    input [A_WIDTH-1:0] A;
    input [B_WIDTH-1:0] B;
    input CI, BI;
    output [Y_WIDTH-1:0] X, Y, CO;

    wire [Y_WIDTH-1:0] a, b;
    generate
        if (A_WIDTH == 0) assign a = 0;
        else \$pos #(.A_SIGNED(A_SIGNED), .A_WIDTH(A_WIDTH), .Y_WIDTH(Y_WIDTH)) extend_a (.A(A), .Y(a));
        if (B_WIDTH == 0) assign b = 0;
        else \$pos #(.A_SIGNED(B_SIGNED), .A_WIDTH(B_WIDTH), .Y_WIDTH(Y_WIDTH)) extend_b (.A(B), .Y(b));
    endgenerate
    // What is always inverted costs nothing: the element's LUT does it.
    localparam fixed = _TECHMAP_CONSTMSK_BI_;
    localparam inverted = fixed && _TECHMAP_CONSTVAL_BI_;
    wire [Y_WIDTH-1:0] operand = fixed ? b : b ^ {Y_WIDTH{BI}};
    wire [Y_WIDTH:0] carry;
    assign X = a ^ (inverted ? ~operand : operand);
    assign carry[0] = CI;
    assign CO = carry[Y_WIDTH:1];
    genvar i;
    generate
        for (i = 0; i < Y_WIDTH; i = i + 1) begin : bits
            CARRYLE #(.INVERT_B(inverted)) element (.a(a[i]), .b(operand[i]), .ci(carry[i]), .s(Y[i]), .co(carry[i+1]));
        end
    endgenerate
endmodule
