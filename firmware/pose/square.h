// The marker as a square of half side 1, its pose in those units, and how well a pose explains its image.
#ifndef POSE_SQUARE_H
#define POSE_SQUARE_H

#include "pose.h"
#include "quad.h"

// A vertex nearer to the camera's plane than this, in half sides, counts as behind the camera.
#define MIN_DEPTH 1e-6f

// Lengths in half sides; t is the marker's centre.
struct unit_pose {
    float r[9];  // row by row
    float t[3];
};

// The vectors from the marker's centre to V1..V4 in the camera's axes.
void spokes(const float r[9], float spoke[4][3]);

// Image minus reprojection of the vertices as slopes x, y; returns 0 if one is behind the camera, else 1.
int residuals(const struct unit_pose *pose, const struct quad *quad, float difference[4][2]);

// Root mean square reprojection distance; infinite if a vertex is behind the camera.
float rms_px(const struct unit_pose *pose, const struct quad *quad, const struct pose_camera *camera);

#endif
