#include "housekeeping.h"

#include "clock.h"
#include "crash.h"
#include "display.h"
#include "registers.h"
#include "sentence.h"
#include "serial.h"
#include "settings.h"

static uint32_t shown, told;

void send_status(const struct frame_report *report) {
    volatile rasterpose_t *const sensor = &SYSTEM->sensor;
    const struct status status = {
        .frames = sensor->FRAMES_COMPLETE,
        .skipped = report->skipped,
        .cut = sensor->SHORT_LINES + sensor->LONG_LINES + sensor->SHORT_FRAMES + sensor->MIDLINE_STARTS +
               sensor->BAD_SIZES,
        .lost = SYSTEM->uart.LOST,
        .traps = crash_count(),
        .restarts = SYSTEM->watchdog.EXPIRED,
    };
    char line[SENTENCE_LENGTH];
    serial_send(line, sentence_status(line, clock_now(), &status));
}

static void show(const struct frame_report *report) {
    enum { LINE_1 = 0x80, LINE_2 = 0xC0, TO_SEND = 2 * (1 + DISPLAY_COLUMNS) };
    // A display that cannot follow keeps its last picture; it is never waited for.
    if ((SYSTEM->lcd.STATUS & LCD__STATUS__SPACE_bm) >> LCD__STATUS__SPACE_bp < TO_SEND) return;
    char lines[2][DISPLAY_COLUMNS];
    display_lines(report, lines);
    for (int line = 0; line < 2; line++) {
        SYSTEM->lcd.COMMAND = line ? LINE_2 : LINE_1;
        for (int column = 0; column < DISPLAY_COLUMNS; column++) SYSTEM->lcd.DATA = (uint8_t)lines[line][column];
    }
}

void housekeeping(uint32_t ticks, const struct frame_report *report) {
    if (settings.display_ticks && ticks - shown >= settings.display_ticks) {
        shown = ticks;
        show(report);
    }
    if (settings.status_ticks && ticks - told >= settings.status_ticks) {
        told = ticks;
        send_status(report);
    }
}
