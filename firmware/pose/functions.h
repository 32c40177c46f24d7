// Whose square root, sine, cosine and arc tangent classic coplanar POSIT works with: one choice at compile time.
//
// -DPOSE_FUNCTIONS=POSE_EXACT, the default: the correctly rounded square root; the complex root needs no angle.
// -DPOSE_FUNCTIONS=POSE_APPROXIMATIONS: the paper's. Square roots are x * invsqrt(x) with one Newton step, the
//     complex root goes through its angle by equations 2, 3 and 5. The rows of the rotation come out up to 0.18 %
//     too long, the third up to 0.35 %, as the paper prints them; the rotation is up to 1.5 degrees off and the depth
//     between -0.2 and 0.5 % (measured, tilts of 25 to 60 degrees).
// -DPOSE_FUNCTIONS=POSE_LIBRARY: as the paper's, with the C library's sinf, cosf and atanf, which must be linked, and
//     its sqrtf where the processor has no square root.
#ifndef POSE_FUNCTIONS_H
#define POSE_FUNCTIONS_H

#define POSE_EXACT 0
#define POSE_APPROXIMATIONS 1
#define POSE_LIBRARY 2

#ifndef POSE_FUNCTIONS
#define POSE_FUNCTIONS POSE_EXACT
#endif

#if POSE_FUNCTIONS == POSE_EXACT
#define POSE_SQRT __builtin_sqrtf
#elif POSE_FUNCTIONS == POSE_APPROXIMATIONS
#define POSE_SQRT pose_sqrt_one_step
#define POSE_SIN pose_sin_taylor
#define POSE_COS pose_cos_taylor
#define POSE_ATAN pose_atan_taylor
#elif POSE_FUNCTIONS == POSE_LIBRARY
#define POSE_SQRT __builtin_sqrtf
#define POSE_SIN __builtin_sinf
#define POSE_COS __builtin_cosf
#define POSE_ATAN __builtin_atanf
#else
#error "POSE_FUNCTIONS must be POSE_EXACT, POSE_APPROXIMATIONS or POSE_LIBRARY"
#endif

#endif
