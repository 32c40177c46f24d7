// What C has no operator and no word for: operations on floats, without libm, and a wish about loops.
#ifndef POSE_NUMBER_H
#define POSE_NUMBER_H

// Before a loop whose copies would cost more in the instruction cache than they save.
#ifdef __clang__
#define POSE_ROLLED _Pragma("clang loop unroll(disable)")
#else
#define POSE_ROLLED
#endif

// With -fno-math-errno this is the processor's own square root, correctly rounded.
static inline float pose_sqrt(float x) { return __builtin_sqrtf(x); }

static inline float pose_abs(float x) { return __builtin_fabsf(x); }

// The first unless the second is larger, as Python's max.
static inline float pose_max(float a, float b) { return b > a ? b : a; }

// False for infinities and NaN.
static inline int pose_is_finite(float x) { return pose_abs(x) < __builtin_inff(); }

#endif
