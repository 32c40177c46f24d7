// Time since the start from the sensor's 32-bit clock counter, which wraps every 86 s at 50 MHz.
#ifndef RASTERPOSE_CLOCK_H
#define RASTERPOSE_CLOCK_H

#include <stdint.h>

#include "sentence.h"

// To be called more often than the counter wraps.
void clock_update(void);

// The moment of a time stamp, of the past and not older than a wrap.
struct moment clock_moment(uint32_t stamp);

struct moment clock_now(void);

#endif
