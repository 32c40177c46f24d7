// The paper's function approximations; see approximations.h.
#include "approximations.h"

#include <stdint.h>

float pose_sin_taylor(float x) {
    float q = x * x;
    return x * (1.0f - q * (0.16666667f - q * (0.008333334f - q * 0.0001984127f)));
}

float pose_cos_taylor(float x) {
    float q = x * x;
    return 1.0f - q * (0.5f - q * (0.041666668f - q * (0.0013888889f - q * 2.4801588e-05f)));
}

float pose_acos_cubic(float x) { return (-0.6981317f * x * x - 0.8726646f) * x + 1.5707963f; }

static float reciprocal_series(float x) {
    float z = 1.0f / x, q = z * z;
    return z * (1.0f - q * (0.33333334f - q * 0.2f));
}

float pose_atan_taylor(float x) {
    if (x >= 1.0f) return POSE_HALF_PI - reciprocal_series(x);
    if (x <= -1.0f) return -POSE_HALF_PI - reciprocal_series(x);
    float q = x * x;
    return x * (1.0f - q * (0.33333334f - q * (0.2f - q * 0.14285715f)));
}

// Halves the exponent and negates it.
static float invsqrt_guess(float x) {
    union {
        float number;
        uint32_t bits;
    } value = {.number = x};
    value.bits = 0x5F3759DFu - (value.bits >> 1);
    return value.number;
}

static float newton_step(float x, float y) { return y * (1.5f - 0.5f * x * y * y); }

float pose_invsqrt_one_step(float x) { return newton_step(x, invsqrt_guess(x)); }

float pose_invsqrt_two_steps(float x) { return newton_step(x, pose_invsqrt_one_step(x)); }

float pose_sqrt_one_step(float x) { return x * pose_invsqrt_one_step(x); }

float pose_sqrt_two_steps(float x) { return x * pose_invsqrt_two_steps(x); }
