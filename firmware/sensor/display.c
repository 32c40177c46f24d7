#include "display.h"

#include "text.h"

static const float DEGREES = 57.29578f;

// A line to its full length.
static void pad(char *at, const char *line) {
    while (at < line + DISPLAY_COLUMNS) *at++ = ' ';
}

void display_lines(const struct frame_report *frame, char lines[2][DISPLAY_COLUMNS]) {
    const struct pose_estimate *const estimate = &frame->marker[0].estimate;
    char *first = lines[0], *second = lines[1];
    if (frame->markers == 0) {
        first = text_string(first, "no marker");
    } else if (estimate->error != POSE_OK) {
        first = text_string(first, "no pose");
    } else {
        float angles[3];
        pose_angles(estimate->pose.r, angles);
        for (int axis = 0; axis < 3; axis++) {
            if (axis) *first++ = *second++ = ' ';
            first = text_column(first, text_round(estimate->pose.t_mm[axis], 1.0f), 4);
            second = text_column(second, text_round(angles[axis], DEGREES), 4);
        }
        first = text_string(first, "mm");
        *second++ = '\xDF';  // the degree sign of the HD44780's character set
    }
    pad(first, lines[0]);
    pad(second, lines[1]);
}
