#include "estimate.h"

#include "number.h"

// Two rotations nearer than 1 degree are one pose: 8 sin^2(0.5 degrees), as |R1 - R2|^2 = 8 sin^2(angle / 2).
#define SAME_ROTATION 6.0922e-4f

int is_valid(const struct pose *pose) {
    const float *r = pose->r, *t = pose->t_mm;
    return r[2] * t[0] + r[5] * t[1] + r[8] * t[2] > 0.0f && pose_is_finite(pose->rms_px) && pose_is_finite(t[0]) &&
           pose_is_finite(t[1]) && pose_is_finite(t[2]);
}

static int are_distinct(const float a[9], const float b[9]) {
    float total = 0.0f;
    for (int n = 0; n < 9; n++) {
        float difference = a[n] - b[n];
        total += difference * difference;
    }
    return total > SAME_ROTATION;
}

void answer_error(enum pose_error error, struct pose_estimate *estimate) {
    *estimate = (struct pose_estimate){.error = (int32_t)error};
}

void answer_found(const struct found *found, struct pose_estimate *estimate) {
    if (found->count == 0) {
        answer_error(POSE_BEHIND_CAMERA, estimate);
        return;
    }
    int best = found->count == 2 && found->pose[1].rms_px < found->pose[0].rms_px;
    int second = found->count - 1 - best;
    estimate->error = POSE_OK;
    estimate->iterations = found->iterations[best];
    estimate->pose = found->pose[best];
    estimate->has_other = are_distinct(found->pose[best].r, found->pose[second].r);
    if (estimate->has_other)
        estimate->other = found->pose[second];
    else
        estimate->other = (struct pose){0};
}
