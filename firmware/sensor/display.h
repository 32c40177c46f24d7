// The 16 x 2 characters of the LCD.
#ifndef RASTERPOSE_DISPLAY_H
#define RASTERPOSE_DISPLAY_H

#include "report.h"

enum { DISPLAY_COLUMNS = 16 };

// Two lines of 16 characters: the first marker's x, y, z in mm and roll, pitch, yaw in degrees. A line without a final
// 0.
void display_lines(const struct frame_report *frame, char lines[2][DISPLAY_COLUMNS]);

#endif
