// From published frames to sentences: the sensor's program.
//
//   frame interrupt -> frame_take -> pose_centred for each marker -> $RPPOS, $RPCOV
//   timer interrupt -> housekeeping: $RPSTA, LCD
//
// Everything but two flags happens in the main loop. A frame is read at once and let go, so the sensor can publish the
// next one during the arithmetic; what is published and replaced before the loop comes back to it is skipped, as a
// whole frame, and counted.
#include "clock.h"
#include "crash.h"
#include "frame.h"
#include "housekeeping.h"
#include "platform.h"
#include "registers.h"
#include "sentence.h"
#include "serial.h"
#include "settings.h"
#include "vertex.h"

enum { SECTION_POSE = 1, SECTION_TEXT = 2, SECTION_FRAME = 3 };  // of the performance counter
enum { KICK = 0x5AFE };                                          // what the watchdog wants to hear

struct frame_report report;

static volatile uint32_t frames_ready, ticks;

// Called by the platform for an external interrupt: line 0, the sensor.
void interrupt_external(void) {
    SYSTEM->sensor.IRQ_STATUS = RASTERPOSE__IRQ_STATUS__PUBLISHED_bm;
    frames_ready++;
}

// Called by the platform for a timer interrupt.
void interrupt_timer(void) {
    SYSTEM->timer.STATUS = INTERVAL_TIMER__STATUS__EXPIRED_bm;
    ticks++;
    clock_update();
}

static void start(void) {
    SYSTEM->sensor.HOLD = 0;
    SYSTEM->uart.DIVISOR = settings.uart_divisor;
    SYSTEM->watchdog.LIMIT = settings.watchdog_clocks;
    SYSTEM->timer.PERIOD = settings.tick_clocks - 1u;
    SYSTEM->timer.CONTROL = INTERVAL_TIMER__CONTROL__RUN_bm | INTERVAL_TIMER__CONTROL__CONTINUOUS_bm;
    SYSTEM->timer.IRQ_ENABLE = INTERVAL_TIMER__IRQ_ENABLE__EXPIRED_bm;
    SYSTEM->performance.START = 1u;
    SYSTEM->sensor.IRQ_ENABLE = RASTERPOSE__IRQ_ENABLE__PUBLISHED_bm;
    platform_enable_interrupts();
}

// After every step that has a bound. A slow serial line has one for a sentence, but too long a one for a frame.
static void kick(void) { SYSTEM->watchdog.KICK = KICK; }

static int lens_bends(void) {
    const struct pose_lens *const lens = &settings.lens;
    return lens->k1 != 0.0f || lens->k2 != 0.0f || lens->p1 != 0.0f || lens->p2 != 0.0f;
}

static void find_pose(struct marker_report *marker) {
    float unbent[8];
    const float *vertices = marker->vertices_px;
    SYSTEM->performance.START = 1u << SECTION_POSE;
    const uint32_t before = platform_clocks();
    if (lens_bends()) {
        pose_unbend(marker->vertices_px, &settings.pose.camera, &settings.lens,
                    (marker->quality & QUALITY_REFINED) != 0, unbent);
        vertices = unbent;
    }
    pose_centred(vertices, &settings.pose, &marker->estimate);
    marker->clocks = platform_clocks() - before;
    SYSTEM->performance.STOP = 1u << SECTION_POSE;
    pose_quaternion(marker->estimate.pose.r, marker->quaternion);
    marker->ambiguity = pose_ambiguity(&marker->estimate);
}

static void tell_covariance(char *line, struct moment time, uint32_t number) {
    const struct marker_report *const marker = &report.marker[number];
    float covariance[36];
    if (marker->estimate.error != POSE_OK) return;
    const float sigma_px = vertex_sigma(marker->quality, &settings.pose);
    pose_covariance(&marker->estimate.pose, &settings.pose, sigma_px, covariance);
    serial_send(line, sentence_covariance(line, report.frame, time, number, covariance));
}

// All poses, then all sentences: each of the two fills the instruction cache.
static void process_frame(void) {
    char line[SENTENCE_LENGTH];
    SYSTEM->performance.START = 1u << SECTION_FRAME;
    if (frame_take(&report)) {
        for (uint32_t number = 0; number < report.markers; number++) {
            kick();
            find_pose(&report.marker[number]);
        }
        SYSTEM->performance.START = 1u << SECTION_TEXT;
        const struct moment time = clock_moment(report.first_pixel);
        serial_send(line, sentence_frame(line, &report, time));
        for (uint32_t number = 0; number < report.markers; number++) {
            kick();
            serial_send(line, sentence_pose(line, report.frame, time, number, &report.marker[number]));
            if (settings.covariance) tell_covariance(line, time, number);
        }
        SYSTEM->performance.STOP = 1u << SECTION_TEXT;
        report.sequence++;
    }
    SYSTEM->performance.STOP = 1u << SECTION_FRAME;
}

int main(void) {
    uint32_t frames_seen = 0, ticks_seen = 0;
    start();
    crash_report();
    send_status(&report);
    for (;;) {
        kick();
        platform_mask_interrupts();
        if (frames_ready == frames_seen && ticks == ticks_seen) platform_wait_for_interrupt();
        platform_unmask_interrupts(1);
        if (frames_ready != frames_seen) {
            frames_seen = frames_ready;
            process_frame();
        }
        if (ticks != ticks_seen) {
            ticks_seen = ticks;
            housekeeping(ticks_seen, &report);
        }
    }
}
