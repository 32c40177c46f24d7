#include "number.h"
#include "pose.h"

static void to_quaternion(const float r[9], float q[4]) {
    float trace = r[0] + r[4] + r[8];
    if (trace > 0.0f) {
        float root = pose_sqrt(trace + 1.0f);
        float part = 0.5f / root;
        q[0] = root * 0.5f;
        q[1] = (r[7] - r[5]) * part;
        q[2] = (r[2] - r[6]) * part;
        q[3] = (r[3] - r[1]) * part;
        return;
    }
    int i = 0;
    if (r[4] > r[0]) i = 1;
    if (r[8] > r[4 * i]) i = 2;
    int j = (i + 1) % 3, k = (i + 2) % 3;
    float root = pose_sqrt(r[4 * i] - r[4 * j] - r[4 * k] + 1.0f);
    float part = 0.5f / root;
    q[0] = (r[3 * k + j] - r[3 * j + k]) * part;
    q[1 + i] = root * 0.5f;
    q[1 + j] = (r[3 * j + i] + r[3 * i + j]) * part;
    q[1 + k] = (r[3 * k + i] + r[3 * i + k]) * part;
}

void pose_quaternion(const float r[9], float q[4]) {
    to_quaternion(r, q);
    int first = 0;  // that is not zero
    while (first < 3 && q[first] == 0.0f) first++;
    if (q[first] < 0.0f)
        for (int n = 0; n < 4; n++) q[n] = 0.0f - q[n];
}

float pose_ambiguity(const struct pose_estimate *estimate) {
    if (!estimate->has_other) return 0.0f;
    return estimate->other.rms_px > 0.0f ? estimate->pose.rms_px / estimate->other.rms_px : 1.0f;
}
