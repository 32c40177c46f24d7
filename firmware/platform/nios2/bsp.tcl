# Settings of the board support package: nios2-bsp hal bsp system.sopcinfo --script=bsp.tcl
# No files, no C++, no standard streams: the program talks through its own UART.

set_setting hal.make.bsp_cflags_optimization -O2
set_setting hal.enable_c_plus_plus false
set_setting hal.enable_clean_exit false
set_setting hal.enable_exit false
set_setting hal.enable_reduced_device_drivers true
set_setting hal.enable_small_c_library true
set_setting hal.enable_sopc_sysid_check false
set_setting hal.enable_instruction_related_exceptions_api true
set_setting hal.max_file_descriptors 4
set_setting hal.stdin none
set_setting hal.stdout none
set_setting hal.stderr none
set_setting hal.sys_clk_timer none
set_setting hal.timestamp_timer none

# What a restart must not clear has a section of its own, and so have the settings, which may be changed in the image.
add_section_mapping .noinit ram
add_section_mapping .settings ram
