// Published frames, from the sensor's registers to memory.
#ifndef RASTERPOSE_FRAME_H
#define RASTERPOSE_FRAME_H

#include "report.h"

// Read the published frame while it is held, and let it go. Other frames that end meanwhile are skipped by the sensor.
// Returns 0, and leaves the report as it was, if nothing new is published.
int frame_take(struct frame_report *report);

#endif
