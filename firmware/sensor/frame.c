#include "frame.h"

#include "registers.h"

enum { PATIENCE = 100000 };  // polls, of more than 5 clocks each; 32 markers are refined in 300,000 clocks

static uint32_t next_number;
static int started;

static int hold(void) {
    SYSTEM->sensor.HOLD = RASTERPOSE__HOLD__KEEP_bm;
    for (int poll = 0; poll < PATIENCE; poll++) {
        if (SYSTEM->sensor.STATUS & RASTERPOSE__STATUS__HELD_bm) return 1;
    }
    return 0;
}

// As signed numbers, which coordinates are not: the floating-point unit converts no others. Whole pixels and 256ths of
// one fit into single precision, so the sum is exact.
static void read_vertex(float *vertex, uint32_t word, uint32_t offset) {
    vertex[0] = (float)(((int32_t)(int16_t)word << 8) + (int16_t)offset) * (1.0f / 256.0f);
    vertex[1] = (float)(((int32_t)word >> 16 << 8) + ((int32_t)offset >> 16)) * (1.0f / 256.0f);
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
            read_vertex(vertices + 0, marker->v1, marker->offset1);
            read_vertex(vertices + 2, marker->v2, marker->offset2);
            read_vertex(vertices + 4, marker->v3, marker->offset3);
            read_vertex(vertices + 6, marker->v4, marker->offset4);
            report->marker[number].quality = marker->quality;
        }
        next_number = frame + 1u;
        started = 1;
    }
    SYSTEM->sensor.HOLD = 0;
    return taken;
}
