// The paper's function approximations (section 4.6.4, equations 2 to 5), and the fast inverse square root.
//
// Angles in rad. Domains, largest errors and what lies outside: firmware/reference/approximations.py, whose
// results these are bit for bit.
#ifndef POSE_APPROXIMATIONS_H
#define POSE_APPROXIMATIONS_H

#define POSE_PI 3.1415927f
#define POSE_HALF_PI 1.5707964f

// Taylor series to x^7 and to x^8, for -pi to pi.
float pose_sin_taylor(float x);
float pose_cos_taylor(float x);

// A cubic, for -1 to 1; up to 10.3 degrees off.
float pose_acos_cubic(float x);

// Taylor series in x within -1 < x < 1, in 1/x outside; up to 4.7 degrees off, at +-1.
float pose_atan_taylor(float x);

// 1/sqrt(x) for a normal x > 0 by a guess on the bits and one or two Newton steps: 0.18 % and 0.0005 % at most.
float pose_invsqrt_one_step(float x);
float pose_invsqrt_two_steps(float x);

// x times these; 0 for 0.
float pose_sqrt_one_step(float x);
float pose_sqrt_two_steps(float x);

#endif
