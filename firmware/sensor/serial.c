#include "serial.h"

#include "registers.h"

void serial_send(const char *line, int length) {
    // The queue drains at the serial rate, whatever happens, so this ends.
    while ((int)(SYSTEM->uart.STATUS & UART__STATUS__SPACE_bm) < length) continue;
    for (int at = 0; at < length; at++) SYSTEM->uart.DATA = (uint8_t)line[at];
}
