#include "posit.h"

#include "number.h"

void complex_root(float c, float s, float r, float *lam, float *mu) {
    if (!(r > 0.0f)) {
        *lam = r;
        *mu = r;
        return;
    }
    // The larger part comes from the sum that cannot cancel, the smaller by division.
    float larger = pose_sqrt((r + pose_abs(c)) * 0.5f);
    float smaller = s * 0.5f / larger;
    if (c >= 0.0f) {
        *lam = larger;
        *mu = smaller;
    } else {
        *lam = smaller;
        *mu = larger;
    }
}
