// A DE2-115 with what is plugged in: a camera, whose pins are inputs here, the pull-ups of its I2C bus, a display that
// drives its data bus when it is read, and what goes to the monitor and its converter.
module de2_115_bench (
    input         clock_50,
    input   [1:0] key,
    input  [17:0] sw,
    output [17:0] ledr,
    output  [8:0] ledg,
    output [55:0] hex,
    input   [7:0] lcd_out,
    output  [7:0] lcd_in,
    output        lcd_e,
    output        lcd_rs,
    output        lcd_rw,
    output        vga_clk,
    output [27:0] vga,
    output        txd,
    input         rxd,
    input         pixlclk,
    input  [11:0] data,
    input         fval,
    input         lval,
    output        xclkin,
    output        reset_n,
    input         scl_pulled,
    input         sda_pulled,
    output        scl,
    output        sda
);
    wire [7:0] lcd_data;
    wire       scl_line, sda_line;

    pullup (scl_line);
    pullup (sda_line);
    assign scl_line = scl_pulled ? 1'b0 : 1'bz;
    assign sda_line = sda_pulled ? 1'b0 : 1'bz;
    assign scl = scl_line;
    assign sda = sda_line;
    assign lcd_data = lcd_rw ? lcd_out : 8'bz;
    assign lcd_in = lcd_data;

    de2_115 board (
        .CLOCK_50(clock_50), .KEY(key), .SW(sw), .LEDR(ledr), .LEDG(ledg),
        .HEX0(hex[6:0]), .HEX1(hex[13:7]), .HEX2(hex[20:14]), .HEX3(hex[27:21]),
        .HEX4(hex[34:28]), .HEX5(hex[41:35]), .HEX6(hex[48:42]), .HEX7(hex[55:49]),
        .LCD_DATA(lcd_data), .LCD_EN(lcd_e), .LCD_RS(lcd_rs), .LCD_RW(lcd_rw), .LCD_ON(), .LCD_BLON(),
        .VGA_CLK(vga_clk), .VGA_SYNC_N(vga[27]), .VGA_BLANK_N(vga[26]), .VGA_VS(vga[25]), .VGA_HS(vga[24]),
        .VGA_R(vga[23:16]), .VGA_G(vga[15:8]), .VGA_B(vga[7:0]),
        .UART_TXD(txd), .UART_RXD(rxd),
        .D5M_D(data), .D5M_FVAL(fval), .D5M_LVAL(lval), .D5M_PIXLCLK(pixlclk), .D5M_XCLKIN(xclkin),
        .D5M_RESET_N(reset_n), .D5M_TRIGGER(), .D5M_SCLK(scl_line), .D5M_SDATA(sda_line)
    );
endmodule
