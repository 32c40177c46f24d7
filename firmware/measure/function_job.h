// Inputs of function_clocks.c.
#ifndef RASTERPOSE_FUNCTION_JOB_H
#define RASTERPOSE_FUNCTION_JOB_H

#include <stdint.h>

enum { MOST_INPUTS = 250 };

struct job {
    uint32_t function;  // index into `functions`
    uint32_t count;
    float inputs[MOST_INPUTS];
};

extern const struct job job;

#endif
