// A ULX3S with what is plugged in: a camera, whose pins are inputs here, and the pull-ups of its two-wire bus.
module ulx3s_bench (
    input        oscillator,
    input        reset_n,
    input        fire,
    output [7:0] led,
    output       txd,
    output [3:0] gpdi,
    input        pclk,
    input  [7:0] data,
    input        href,
    input        vsync,
    output       xclk,
    output       camera_reset_n,
    input        scl_pulled,
    input        sda_pulled,
    output       scl,
    output       sda
);
    wire scl_line, sda_line;

    pullup (scl_line);
    pullup (sda_line);
    assign scl_line = scl_pulled ? 1'b0 : 1'bz;
    assign sda_line = sda_pulled ? 1'b0 : 1'bz;
    assign scl = scl_line;
    assign sda = sda_line;

    ulx3s board (
        .clk_25mhz(oscillator), .btn_pwr_n(reset_n), .btn_fire1(fire), .led(led), .ftdi_rxd(txd), .ftdi_txd(1'b1),
        .wifi_gpio0(), .gpdi_dp(gpdi), .cam_pclk(pclk), .cam_href(href), .cam_vsync(vsync), .cam_xclk(xclk),
        .cam_d(data), .cam_sioc(scl_line), .cam_siod(sda_line), .cam_reset_n(camera_reset_n), .cam_pwdn()
    );
endmodule
