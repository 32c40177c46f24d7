#include "crash.h"

#include "platform.h"
#include "sentence.h"
#include "serial.h"

static const uint32_t MAGIC = 0x54524150;

// Keeps its contents over a restart; after configuration it holds anything.
static struct {
    uint32_t magic, count, cause, address, value, reported;
} crash __attribute__((section(".noinit")));

// Called by the platform for every exception. The program starts anew: what it was at is lost, the sensor goes on.
void trap(uint32_t cause, uint32_t address, uint32_t value) {
    if (crash.magic != MAGIC) crash.count = 0;
    crash.magic = MAGIC;
    crash.count++;
    crash.cause = cause;
    crash.address = address;
    crash.value = value;
    crash.reported = 0;
    platform_restart();
}

uint32_t crash_count(void) { return crash.magic == MAGIC ? crash.count : 0; }

void crash_report(void) {
    if (crash.magic != MAGIC || crash.reported) return;
    crash.reported = 1;
    char line[SENTENCE_LENGTH];
    serial_send(line, sentence_trap(line, crash.cause, crash.address, crash.value));
}
