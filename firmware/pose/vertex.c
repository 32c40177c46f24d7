#include "vertex.h"

#include "number.h"

// Of a whole-pixel vertex, measured: 1.24 px rms over both coordinates.
#define WHOLE_SIGMA_PX 0.88f

// A vertex lies where two fitted lines end, and neighbouring points share their noise: its variance is this many times
// that of a line's points over their number. Measured, tests/models/test_covariance.py. Unpolished poses scatter more
// than their vertices ask for.
#define POLISHED_FACTOR 9.75f
#define UNPOLISHED_FACTOR 16.5f

// The residual is cut off, in 1/4096 square pixel.
#define RESIDUAL_STEP (1.0f / 4096.0f)

// By the bits of 2^23 and more, because the floating-point unit converts signed numbers alone.
static float twelve_bits(uint32_t word) {
    const union {
        uint32_t bits;
        float value;
    } number = {.bits = 0x4B000000u | (word & 0xFFFu)};
    return number.value - 8388608.0f;
}

float vertex_sigma(uint32_t quality, const struct pose_options *options) {
    if (!(quality & QUALITY_REFINED)) return WHOLE_SIGMA_PX;
    float factor = options->polish_steps > 0 ? POLISHED_FACTOR : UNPOLISHED_FACTOR;
    return pose_sqrt((twelve_bits(quality) + 0.5f) * RESIDUAL_STEP * factor / twelve_bits(quality >> 12));
}
