// The last frame's results, in memory under the symbol `report` for whoever can read it: the simulation, a debugger, a
// host behind the host port. They belong together while `sequence` is even and does not change.
#ifndef RASTERPOSE_REPORT_H
#define RASTERPOSE_REPORT_H

#include <stdint.h>

#include "pose.h"

enum { REPORT_MARKERS = 64 };

struct marker_report {
    float vertices_px[8];  // x, y of V1 to V4, as the camera sees them
    uint32_t quality;      // the hardware's word: whether they are refined, and how well they fit
    struct pose_estimate estimate;
    float quaternion[4];  // w x y z
    float ambiguity;      // 0 to 1
    uint32_t clocks;      // that the estimate took
};

struct frame_report {
    uint32_t sequence;     // odd while it is being written
    uint32_t frame;        // number
    uint32_t first_pixel;  // time stamps, clocks
    uint32_t last_pixel;
    uint32_t markers;  // number of entries of `marker` that are valid
    uint32_t skipped;  // complete frames since the start that were not taken
    struct marker_report marker[REPORT_MARKERS];
};

extern struct frame_report report;

#endif
