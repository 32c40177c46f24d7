// The serial port: whole lines or nothing.
#ifndef RASTERPOSE_SERIAL_H
#define RASTERPOSE_SERIAL_H

// Puts a line into the UART's queue, as soon as it has room for all of it.
void serial_send(const char *line, int length);

#endif
