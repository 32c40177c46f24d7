// Gauss-Newton on the reprojection.
#ifndef POSE_POLISH_H
#define POSE_POLISH_H

#include "linear.h"
#include "square.h"

// Improve a pose by at most `steps` steps, none if that is not positive; returns rms_px of the result.
float polish(struct unit_pose *pose, const struct quad *quad, const struct pose_camera *camera, int32_t steps);

// J'J, its lower triangle, and J'r of a pose in front of the camera, r given as slopes. The parameters are a small
// turn about the centre in the camera's axes and a shift of the centre in half sides.
void normal_equations(const struct unit_pose *pose, float difference[4][2], const struct pose_camera *camera,
                      float normal[PARAMETERS][PARAMETERS], float right[PARAMETERS]);

#endif
