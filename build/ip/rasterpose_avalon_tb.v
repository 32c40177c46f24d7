// Sends a rendered frame to the sensor by Avalon-ST Video and reads its marker by Avalon-MM. Self-checking: it prints
// PASS, or what was wrong and FAIL, and ends with an error. What it does is in three files beside it: scene.vh (their
// lengths), beats.hex (what is sent: end of packet, start of packet, data) and transfers.hex (what software does, three
// words each):
//   0 address value   write
//   1 address value   read, and expect this value
//   2 clocks  -       send the beats, then wait for the interrupt for so many clocks at most
`include "scene.vh"

module rasterpose_avalon_tb;
  reg clk, rst;
  reg [23:0] data;
  reg valid, was_ready, startofpacket, endofpacket;
  reg [14:0] address;
  reg read, write;
  reg [31:0] writedata;
  wire ready, irq;
  wire [31:0] readdata;

  reg [25:0] beats [0:`BEATS - 1];
  reg [31:0] transfers [0:3 * `TRANSFERS - 1];
  integer transfer, beat, clocks, faults, words;

  rasterpose_avalon dut (
    .clk(clk),
    .rst(rst),
    .video_data(data),
    .video_valid(valid),
    .video_startofpacket(startofpacket),
    .video_endofpacket(endofpacket),
    .video_ready(ready),
    .registers_address(address),
    .registers_read(read),
    .registers_write(write),
    .registers_writedata(writedata),
    .registers_byteenable(4'b1111),
    .registers_readdata(readdata),
    .irq(irq)
  );

  initial clk = 0;
  always #10 clk = ~clk;

  // Inputs change when the clock falls. readyLatency 1: a beat may come in the clock after one with ready.
  task send;
    begin
      beat = 0;
      while (beat < `BEATS) begin
        @(negedge clk);
        valid = was_ready;
        was_ready = ready;
        {endofpacket, startofpacket, data} = beats[beat];
        if (valid) beat = beat + 1;
      end
      @(negedge clk) valid = 0;
    end
  endtask

  task await_irq(input integer limit);
    begin
      clocks = 0;
      while (!irq && clocks < limit) @(negedge clk) clocks = clocks + 1;
      if (irq !== 1) begin
        faults = faults + 1;
        $display("no interrupt in %0d clocks", limit);
      end
    end
  endtask

  task put(input [31:0] place, input [31:0] value);
    begin
      @(negedge clk);
      address = place >> 2;
      writedata = value;
      write = 1;
      @(negedge clk) write = 0;
    end
  endtask

  task expect_word(input [31:0] place, input [31:0] value);
    begin
      @(negedge clk);
      address = place >> 2;
      read = 1;
      @(negedge clk) read = 0;
      repeat (`READ_LATENCY - 1) @(negedge clk);
      words = words + 1;
      if (readdata !== value) begin
        faults = faults + 1;
        $display("0x%h holds 0x%h instead of 0x%h", place, readdata, value);
      end
    end
  endtask

  initial begin
    $readmemh("beats.hex", beats);
    $readmemh("transfers.hex", transfers);
    {rst, read, write, valid, was_ready} = 5'b10000;
    {startofpacket, endofpacket, data, address, writedata} = 0;
    {faults, words} = 0;
    repeat (4) @(negedge clk);
    rst = 0;
    for (transfer = 0; transfer < 3 * `TRANSFERS; transfer = transfer + 3)
      case (transfers[transfer])
        0: put(transfers[transfer + 1], transfers[transfer + 2]);
        1: expect_word(transfers[transfer + 1], transfers[transfer + 2]);
        2: begin
          send;
          await_irq(transfers[transfer + 1]);
        end
        default: faults = faults + 1;
      endcase
    if (faults == 0 && words != 0) $display("PASS: %0d words as they must be", words);
    else $fatal(1, "FAIL: %0d faults", faults);
    $finish;
  end
endmodule
