// Clocks and results of functions of one number: the approximations, or with -DLIBRARY those of the C library, whose
// square root is the floating-point unit's where there is one.
#include "angles.h"
#include "approximations.h"
#include "function_job.h"
#include "program.h"

struct function {
    char name[20];
    float (*call)(float);
};

float results[MOST_INPUTS];
uint32_t clocks[MOST_INPUTS];
uint32_t empty_clocks;  // that the two readings of the clock take between themselves

#ifdef LIBRARY

float sinf(float x);
float cosf(float x);
float acosf(float x);
float atanf(float x);

static float root(float x) { return __builtin_sqrtf(x); }
static float inverse_root(float x) { return 1.0f / __builtin_sqrtf(x); }

const struct function functions[] = {
    {"sin", sinf}, {"cos", cosf}, {"acos", acosf}, {"atan", atanf}, {"sqrt", root}, {"invsqrt", inverse_root},
};

#else

static float minimax(float x) { return pose_atan2(x, 1.0f); }

const struct function functions[] = {
    {"sin", pose_sin_taylor},
    {"cos", pose_cos_taylor},
    {"acos", pose_acos_cubic},
    {"atan", pose_atan_taylor},
    {"sqrt", pose_sqrt_one_step},
    {"invsqrt", pose_invsqrt_one_step},
    {"sqrt, 2 steps", pose_sqrt_two_steps},
    {"invsqrt, 2 steps", pose_invsqrt_two_steps},
    {"atan, minimax", minimax},
};

#endif

// A call through a pointer and its return are part of the clocks, as they are of any use.
void measure(void) {
    float (*const call)(float) = functions[job.function].call;
    results[0] = call(job.inputs[0]);  // fills the cache
    for (uint32_t number = 0; number < job.count; number++) {
        const float x = job.inputs[number];
        const uint32_t before = platform_clocks();
        const float result = call(x);
        clocks[number] = platform_clocks() - before;
        results[number] = result;
    }
    const uint32_t before = platform_clocks();
    empty_clocks = platform_clocks() - before;
}
