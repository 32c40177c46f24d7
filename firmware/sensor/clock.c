#include "clock.h"

#include "platform.h"
#include "registers.h"

static uint32_t seconds, second_began;  // and the counter then

void clock_update(void) {
    const uint32_t masked = platform_mask_interrupts();
    const uint32_t hz = SYSTEM->system_id.CLOCK_HZ;
    while (SYSTEM->sensor.TIME - second_began >= hz) {
        second_began += hz;
        seconds++;
    }
    platform_unmask_interrupts(masked);
}

struct moment clock_moment(uint32_t stamp) {
    const uint32_t hz = SYSTEM->system_id.CLOCK_HZ;
    clock_update();
    const uint32_t masked = platform_mask_interrupts();
    struct moment moment = {seconds, 0};
    uint32_t since = stamp - second_began;
    platform_unmask_interrupts(masked);
    // A stamp of an earlier second is as far below 0.
    while (since >= hz && moment.seconds) {
        since += hz;
        moment.seconds--;
    }
    moment.microseconds = since / (hz / 1000000u);
    return moment;
}

struct moment clock_now(void) { return clock_moment(SYSTEM->sensor.TIME); }
