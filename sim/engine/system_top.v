// The system with a register on every input (see sensor_top.v for why), and with a host that makes one access for each
// clock of `request`. An access is over when `done` is set; a new one may be requested in that clock.
module system_top (
    input             clk,
    input             rst,
    input             halt,
    input             camera__valid,
    input      [25:0] camera__payload,
    input             request,
    input             write,
    input      [31:0] address,
    input      [31:0] write_data,
    output            done,
    output     [31:0] read_data,
    output            sent__valid,
    output      [7:0] sent__payload,
    output            irq,
    output            tx
);
    reg        reset, halted, valid, busy, writes;
    reg [25:0] pixel;
    reg [29:0] word;
    reg [31:0] data;

    always @(posedge clk) begin
        reset <= rst;
        halted <= halt;
        valid <= camera__valid;
        pixel <= camera__payload;
        if (request) begin
            word <= address[31:2];
            writes <= write;
            data <= write_data;
        end
        busy <= request | busy & ~done & ~rst;
    end

    rasterpose_system system (
        .clk(clk), .rst(reset), .halt(halted), .camera__valid(valid), .camera__payload(pixel),
        .host__valid(busy), .host__write(writes), .host__burst(1'b0), .host__address(word), .host__select(4'b1111),
        .host__write_data(data), .host__ack(done), .host__read_data(read_data),
        .sent__valid(sent__valid), .sent__payload(sent__payload), .irq(irq), .tx(tx), .rx(1'b1),
        .lcd__data_i(8'h00)
    );
endmodule
