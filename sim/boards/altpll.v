// What Altera's ALTPLL does for the DE2-115, for simulation: outputs that are the input divided by 1 or by an even
// number, without multiplication; locked after 16 clocks. What it cannot do gives a clock that never moves.
module altpll #(
    parameter lpm_type = "altpll", intended_device_family = "", operation_mode = "", compensate_clock = "",
    parameter pll_type = "", bandwidth_type = "", self_reset_on_loss_lock = "",
    parameter inclk0_input_frequency = 20000, width_clock = 5,
    parameter port_inclk0 = "", port_locked = "", port_areset = "",
    parameter port_clk0 = "PORT_UNUSED", port_clk1 = "PORT_UNUSED", port_clk2 = "PORT_UNUSED",
    parameter clk0_multiply_by = 0, clk0_divide_by = 1, clk0_duty_cycle = 50, clk0_phase_shift = "0",
    parameter clk1_multiply_by = 0, clk1_divide_by = 1, clk1_duty_cycle = 50, clk1_phase_shift = "0",
    parameter clk2_multiply_by = 0, clk2_divide_by = 1, clk2_duty_cycle = 50, clk2_phase_shift = "0"
) (
    input [1:0] inclk,
    output [width_clock-1:0] clk,
    output locked
);
    wire divided0, divided1, divided2;

    clock_divider #(.FACTOR(clk0_multiply_by), .DIVISOR(clk0_divide_by)) divider0 (.in(inclk[0]), .out(divided0));
    clock_divider #(.FACTOR(clk1_multiply_by), .DIVISOR(clk1_divide_by)) divider1 (.in(inclk[0]), .out(divided1));
    clock_divider #(.FACTOR(clk2_multiply_by), .DIVISOR(clk2_divide_by)) divider2 (.in(inclk[0]), .out(divided2));
    assign clk = {2'b00, divided2, divided1, divided0};

    reg [4:0] count = 0;
    always @(posedge inclk[0]) if (!locked) count <= count + 5'd1;
    assign locked = count[4];
endmodule

module clock_divider #(parameter FACTOR = 1, DIVISOR = 1) (input in, output out);
    reg [15:0] count = 0;
    reg divided = 0;
    always @(posedge in) begin
        count <= count + 16'd1;
        if (count == DIVISOR / 2 - 1) begin
            count <= 0;
            divided <= !divided;
        end
    end
    generate
        if (FACTOR == 1 && DIVISOR == 1) begin : gen_same
            assign out = in;
        end else if (FACTOR == 1 && DIVISOR % 2 == 0) begin : gen_divided
            assign out = divided;
        end else begin : gen_none
            assign out = 1'b0;
        end
    endgenerate
endmodule
