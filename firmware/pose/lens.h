// What a lens bends, undone before the pose: OpenCV's model with two radial and two tangential coefficients.
#ifndef POSE_LENS_H
#define POSE_LENS_H

#include "pose.h"

struct pose_lens {
    float k1, k2, p1, p2;  // radial of r^2 and r^4, tangential; all 0: a pinhole
};

// Where a pinhole camera would see the vertices that this one sees at `seen_px`. They become not a number where the
// lens shows no ray there.
//
// are_lines: the vertices lie where straight lines meet that were fitted to the sides, which are bent. Such a line
// crosses the side at two points, 1/sqrt(3) of what was fitted from its middle; unbent they tell the straight side.
void pose_unbend(const float seen_px[8], const struct pose_camera *camera, const struct pose_lens *lens, int are_lines,
                 float vertices_px[8]);

#endif
