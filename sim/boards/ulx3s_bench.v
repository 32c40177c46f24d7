// A ULX3S with what is plugged in: a camera, whose pins are inputs here, the pull-ups of its two-wire bus, and a
// receiver of ten bits of each channel of the cable, the first in the lowest place. It does not know where words begin.
// A bit lasts for two clocks of the oscillator's pin, see ehxplll.v, and changes when that rises.
module ulx3s_bench (
    input        oscillator,
    input        reset_n,
    input        fire,
    output [7:0] led,
    output       txd,
    output reg        received,
    output reg [39:0] ten_bits,
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

    wire  [3:0] gpdi;
    reg  [35:0] nine_bits = 0;
    reg   [3:0] count = 0;
    reg         is_second = 0;

    initial received = 0;
    always @(negedge oscillator) begin
        is_second <= !is_second;
        if (is_second) begin
            nine_bits <= {gpdi, nine_bits[35:4]};
            count <= count == 9 ? 4'd0 : count + 4'd1;
            if (count == 9) begin
                ten_bits <= {gpdi, nine_bits};
                received <= !received;
            end
        end
    end

    ulx3s board (
        .clk_25mhz(oscillator), .btn_pwr_n(reset_n), .btn_fire1(fire), .led(led), .ftdi_rxd(txd), .ftdi_txd(1'b1),
        .wifi_gpio0(), .gpdi_dp(gpdi), .cam_pclk(pclk), .cam_href(href), .cam_vsync(vsync), .cam_xclk(xclk),
        .cam_d(data), .cam_sioc(scl_line), .cam_siod(sda_line), .cam_reset_n(camera_reset_n), .cam_pwdn()
    );
endmodule
