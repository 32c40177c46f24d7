// What is known of traps, across the restart that follows each.
#ifndef RASTERPOSE_CRASH_H
#define RASTERPOSE_CRASH_H

#include <stdint.h>

// Traps since the configuration of the FPGA.
uint32_t crash_count(void);

// Sends a $RPTRP for the last trap, once.
void crash_report(void);

#endif
