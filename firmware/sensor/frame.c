#include "frame.h"

#include "registers.h"

enum { PATIENCE = 10000 };  // polls, of more than 5 clocks each; publishing takes 6,000 clocks at most

static uint32_t next_number;
static int started;

static int hold(void) {
    SYSTEM->sensor.HOLD = RASTERPOSE__HOLD__KEEP_bm;
    for (int poll = 0; poll < PATIENCE; poll++) {
        if (SYSTEM->sensor.STATUS & RASTERPOSE__STATUS__HELD_bm) return 1;
    }
    return 0;
}

// As signed numbers, which coordinates are not: the floating-point unit converts no others.
static void read_vertex(float *vertex, uint32_t word) {
    vertex[0] = (float)(int16_t)word;
    vertex[1] = (float)((int32_t)word >> 16);
}

int frame_take(struct frame_report *report) {
    const int held = hold();
    const uint32_t frame = SYSTEM->sensor.FRAME;
    const int taken = held && !(started && frame + 1u == next_number);
    if (taken) {
        report->sequence++;
        report->frame = frame;
        report->first_pixel = SYSTEM->sensor.FIRST_PIXEL;
        report->last_pixel = SYSTEM->sensor.LAST_PIXEL;
        report->skipped += started ? frame - next_number : frame;
        report->markers = SYSTEM->sensor.MARKERS & RASTERPOSE__MARKERS__COUNT_bm;
        for (uint32_t number = 0; number < report->markers; number++) {
            volatile rasterpose__marker_t *const marker = &SYSTEM->sensor.MARKER_WINDOW[number];
            float *const vertices = report->marker[number].vertices_px;
            read_vertex(vertices + 0, marker->v1);
            read_vertex(vertices + 2, marker->v2);
            read_vertex(vertices + 4, marker->v3);
            read_vertex(vertices + 6, marker->v4);
        }
        next_number = frame + 1u;
        started = 1;
    }
    SYSTEM->sensor.HOLD = 0;
    return taken;
}
