#include "sentence.h"

#include "text.h"

static char *number(char *at, uint32_t value) {
    *at++ = ',';
    return text_unsigned(at, value, 1);
}

static char *decimal(char *at, float value, float scale, int decimals) {
    *at++ = ',';
    return text_decimal(at, text_round(value, scale), decimals);
}

static char *when(char *at, struct moment time) {
    at = number(at, time.seconds);
    *at++ = '.';
    return text_unsigned(at, time.microseconds, 6);
}

// Checksum and end of a line; returns its length.
static int finish(char *line, char *at) {
    uint32_t sum = 0;
    for (const char *c = line + 1; c < at; c++) sum ^= (uint8_t)*c;
    *at++ = '*';
    at = text_hex(at, sum, 2);
    at = text_string(at, "\r\n");
    *at = 0;
    return (int)(at - line);
}

int sentence_frame(char *line, const struct frame_report *frame, struct moment time) {
    char *at = text_string(line, "$RPFRM");
    at = number(at, frame->frame);
    at = when(at, time);
    at = number(at, frame->markers);
    at = number(at, frame->skipped);
    return finish(line, at);
}

int sentence_pose(char *line, uint32_t frame, struct moment time, uint32_t index, const struct marker_report *marker) {
    const struct pose_estimate *const estimate = &marker->estimate;
    char *at = text_string(line, "$RPPOS");
    at = number(at, frame);
    at = when(at, time);
    at = number(at, index);
    at = number(at, (uint32_t)estimate->error);
    if (estimate->error == POSE_OK) {
        for (int axis = 0; axis < 3; axis++) at = decimal(at, estimate->pose.t_mm[axis], 1e3f, 3);
        for (int part = 0; part < 4; part++) at = decimal(at, marker->quaternion[part], 1e6f, 6);
        at = decimal(at, estimate->pose.rms_px, 1e3f, 3);
        at = decimal(at, marker->ambiguity, 1e3f, 3);
    } else {
        at = text_string(at, ",,,,,,,,,");
    }
    return finish(line, at);
}

int sentence_covariance(char *line, uint32_t frame, struct moment time, uint32_t index, const float covariance[36]) {
    char *at = text_string(line, "$RPCOV");
    at = number(at, frame);
    at = when(at, time);
    at = number(at, index);
    for (int row = 0; row < 6; row++) {
        for (int column = row; column < 6; column++) {
            const union {
                float value;
                uint32_t bits;
            } word = {.value = covariance[6 * row + column]};
            *at++ = ',';
            at = text_hex(at, word.bits, 8);
        }
    }
    return finish(line, at);
}

int sentence_status(char *line, struct moment time, const struct status *status) {
    char *at = text_string(line, "$RPSTA");
    at = when(at, time);
    at = number(at, status->frames);
    at = number(at, status->skipped);
    at = number(at, status->cut);
    at = number(at, status->lost);
    at = number(at, status->traps);
    at = number(at, status->restarts);
    return finish(line, at);
}

int sentence_trap(char *line, uint32_t cause, uint32_t address, uint32_t value) {
    char *at = text_string(line, "$RPTRP");
    const uint32_t words[] = {cause, address, value};
    for (int field = 0; field < 3; field++) {
        *at++ = ',';
        at = text_hex(at, words[field], 8);
    }
    return finish(line, at);
}
