// The four image points before any pose: slopes of rays, judged.
#ifndef POSE_QUAD_H
#define POSE_QUAD_H

#include "pose.h"

struct quad {
    float x[4], y[4];                    // slopes (X/Z, Y/Z) of the rays to V1..V4
    float diagonal_x[2], diagonal_y[2];  // V3 - V1 and V4 - V2
    float turn[4];                       // V1 V2 V3, V2 V3 V4, V3 V4 V1, V4 V1 V2: twice the triangles' areas
};

// Judge x, y of V1..V4 in px; `quad` is good if this is POSE_OK.
enum pose_error check_quad(const float vertices_px[8], const struct pose_camera *camera, struct quad *quad);

// Where the diagonals cross, as parts of V1 V3 and of V2 V4: the exact image of the square's centre.
void diagonal_parts(const struct quad *quad, float part[2]);

#endif
