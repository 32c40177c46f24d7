// Inputs and results of pose_clocks.c.
#ifndef RASTERPOSE_POSE_JOB_H
#define RASTERPOSE_POSE_JOB_H

#include "pose.h"

enum { MOST_MARKERS = 20 };

struct job {
    struct pose_options options;
    uint32_t count;                   // of the markers, at least 1
    float vertices[MOST_MARKERS][8];  // x, y of V1 to V4, px
};

struct answer {
    struct pose_estimate estimate;
    uint32_t clocks;
};

extern const struct job job;

#endif
