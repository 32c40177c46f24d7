// What a user sets: the camera, the marker, the serial line. The object lies in the image under the symbol `settings`,
// where tools put other values (firmware.toolchain.image, RtlSystem) without compiling anything.
#ifndef RASTERPOSE_SETTINGS_H
#define RASTERPOSE_SETTINGS_H

#include <stdint.h>

#include "lens.h"
#include "pose.h"

struct settings {
    struct pose_options pose;
    struct pose_lens lens;
    uint32_t uart_divisor;     // clocks per bit
    uint32_t tick_clocks;      // between two timer interrupts
    uint32_t watchdog_clocks;  // without a sign of life, more than tick_clocks and than a line takes; 0: no watchdog
    uint32_t display_ticks;    // between two pictures on the LCD; 0: none
    uint32_t status_ticks;     // between two status sentences; 0: none
    uint32_t covariance;       // 1: $RPCOV after each $RPPOS; 0: none
};

extern const struct settings settings;

#endif
