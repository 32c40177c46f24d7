// The sensor with a register on every input. What depends on an input without a clock in between (with a synchronous
// reset, that is nearly everything) would be worked out twice a clock by Verilator: this makes the simulation a third
// faster, and reading from the bus a clock longer.
module sensor_top (
    input             clk,
    input             rst,
    input             camera__valid,
    input      [25:0] camera__payload,
    input      [13:0] bus__address,
    input             bus__read,
    input             bus__write,
    input      [31:0] bus__write_data,
    output     [31:0] bus__read_data,
    output            irq
);
    reg        reset, valid, read, write;
    reg [25:0] pixel;
    reg [13:0] address;
    reg [31:0] data;

    always @(posedge clk) begin
        reset <= rst;
        valid <= camera__valid;
        pixel <= camera__payload;
        address <= bus__address;
        read <= bus__read;
        write <= bus__write;
        data <= bus__write_data;
    end

    rasterpose sensor (
        .clk(clk), .rst(reset), .camera__valid(valid), .camera__payload(pixel),
        .bus__address(address), .bus__read(read), .bus__write(write), .bus__write_data(data),
        .bus__read_data(bus__read_data), .irq(irq)
    );
endmodule
