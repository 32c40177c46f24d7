// A memory block of memory_libmap as one cell to count.
module \$__M9K_ (...);
    parameter INIT = 0;
    parameter PORT_W_WIDTH = 36;
    parameter PORT_R_WIDTH = 36;
    input CLK_C;
    input PORT_W_CLK, PORT_W_WR_EN;
    input [12:0] PORT_W_ADDR;
    input [PORT_W_WIDTH-1:0] PORT_W_WR_DATA;
    input PORT_R_CLK, PORT_R_CLK_EN;
    input [12:0] PORT_R_ADDR;
    output [PORT_R_WIDTH-1:0] PORT_R_RD_DATA;
    M9K #(.W(PORT_W_WIDTH), .R(PORT_R_WIDTH)) _TECHMAP_REPLACE_ (
        .clk(CLK_C), .we(PORT_W_WR_EN), .wa(PORT_W_ADDR), .wd(PORT_W_WR_DATA),
        .re(PORT_R_CLK_EN), .ra(PORT_R_ADDR), .rd(PORT_R_RD_DATA)
    );
endmodule
