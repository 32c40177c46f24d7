// What both forms of coplanar POSIT share: the root whose two signs are its two solutions.
#ifndef POSE_POSIT_H
#define POSE_POSIT_H

// A square root of c + i s, whose absolute value is r: lam + i mu, the larger of them positive, or both 0.
// lam and mu are the parts of I and J along the plane's normal, with c = J0^2 - I0^2 and s = -2 I0.J0.
void complex_root(float c, float s, float r, float *lam, float *mu);

#endif
