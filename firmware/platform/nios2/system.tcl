# The paper's figure 10 for Platform Designer: qsys-script --script=system.tcl
#
#   figure 10            here
#   CPU                  cpu: Nios II/f, hardware multiplier and divider
#   FP_HW                float: custom instructions 252 to 255 of them; the second generation has 224 to 255
#   JTAG                 jtag
#   ram (200 KB)         ram: 64 KB; the program and its stack need half of that
#   SysID, Timerfms,     sensor: one slave with all registers of hdl/registers.rdl, among them system ID, timer,
#   PerformanceCounter,  performance counter, marker window, LCD and UART
#   X1 to Y4, LCD,
#   ReadAddress
#
# The sensor's slave is at 0x70000000. Software reads it at 0xF0000000: bit 31 keeps the data cache out of it, and the
# program is the same as on the soft core.

package require -exact qsys 16.0

create_system rasterpose
set_project_property DEVICE_FAMILY {Cyclone IV E}
set_project_property DEVICE {EP4CE115F29C7}

add_instance clk clock_source
set_instance_parameter_value clk clockFrequency 50000000

add_instance cpu altera_nios2_gen2
set_instance_parameter_value cpu impl Fast
set_instance_parameter_value cpu mul_32_impl 2
set_instance_parameter_value cpu mul_64_impl 0
set_instance_parameter_value cpu div_impl 1
set_instance_parameter_value cpu resetSlave ram.s1
set_instance_parameter_value cpu exceptionSlave ram.s1
set_instance_parameter_value cpu setting_exportdebuginfo 0
set_instance_parameter_value cpu setting_illegalInstructionsTrap 1
set_instance_parameter_value cpu setting_illegalMemAccessDetection 1

add_instance float altera_nios_custom_instr_floating_point_2

add_instance jtag altera_avalon_jtag_uart

add_instance ram altera_avalon_onchip_memory2
set_instance_parameter_value ram memorySize 65536

# The emitted system without its processor, packaged as a component with an Avalon-MM slave and three interrupt senders.
add_instance sensor rasterpose_registers

foreach name {cpu jtag sensor} {
    add_connection clk.clk $name.clk
    add_connection clk.clk_reset $name.reset
}
add_connection clk.clk ram.clk1
add_connection clk.clk_reset ram.reset1

add_connection cpu.custom_instruction_master float.s1
add_connection cpu.custom_instruction_master float.s2

foreach master {cpu.data_master cpu.instruction_master} {
    add_connection $master ram.s1
    set_connection_parameter_value $master/ram.s1 baseAddress 0x00000000
}
add_connection cpu.data_master jtag.avalon_jtag_slave
set_connection_parameter_value cpu.data_master/jtag.avalon_jtag_slave baseAddress 0x00081100
add_connection cpu.data_master sensor.s1
set_connection_parameter_value cpu.data_master/sensor.s1 baseAddress 0x70000000

set line 0
foreach sender {sensor.irq sensor.uart_irq sensor.timer_irq jtag.irq} {
    add_connection cpu.irq $sender
    set_connection_parameter_value cpu.irq/$sender irqNumber $line
    incr line
}

save_system rasterpose.qsys
