// What both forms of POSIT do with the poses of their two branches: judge them, and answer with the better first.
#ifndef POSE_ESTIMATE_H
#define POSE_ESTIMATE_H

#include "pose.h"

// Collects the valid poses of up to two branches.
struct found {
    int32_t count;
    struct pose pose[2];
    int32_t iterations[2];
};

// 1 if the marker turns its face to the camera and the rms and t are finite.
int is_valid(const struct pose *pose);

// An answer of nothing but this error.
void answer_error(enum pose_error error, struct pose_estimate *estimate);

// The answer from the valid poses; POSE_BEHIND_CAMERA if there is none.
void answer_found(const struct found *found, struct pose_estimate *estimate);

#endif
