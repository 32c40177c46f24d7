// What happens by the clock and not by frames: status sentence and LCD.
#ifndef RASTERPOSE_HOUSEKEEPING_H
#define RASTERPOSE_HOUSEKEEPING_H

#include <stdint.h>

#include "report.h"

void send_status(const struct frame_report *report);

// To be called after every tick, with the number of ticks since the start.
void housekeeping(uint32_t ticks, const struct frame_report *report);

#endif
