// Four vertices of a square marker to its pose.
//
// Frames: the camera's has x right, y down, z forward; the marker's has its origin at the centre, x from V1
// to V2, y from V1 to V4, z into the marker. X_camera = r X_marker + t. Pixel (0, 0) is the centre of the
// upper left pixel.
//
// Everything is single precision, rounded to nearest even, one operation at a time: compile with
// -ffp-contract=off, and the results are bit for bit those of firmware/reference with dtype=numpy.float32.
// The functions have no state, and answer every bit pattern of the vertices with finite numbers.
#ifndef POSE_H
#define POSE_H

#include <stdint.h>

enum pose_error {
    POSE_OK = 0,
    POSE_NOT_FINITE,    // a vertex is not a number, infinite, or 1000 focal lengths off the optical axis
    POSE_DEGENERATE,    // three vertices lie in one line, or the vertices enclose no area
    POSE_NOT_CONVEX,    // the vertices do not run clockwise around a convex quadrilateral
    POSE_BEHIND_CAMERA  // no finite pose has the face and all four vertices in front of the camera
};

// Focal lengths (> 0) and principal point, px.
struct pose_camera {
    float fx, fy, cx, cy;
};

struct pose {
    float r[9];  // row by row; orthonormal within rounding, determinant +1
    float t_mm[3];
    float rms_px;  // root mean square over the vertices of the reprojection distance
};

// What is not used is zero: all but `error` after an error, all of `other` unless `has_other`.
struct pose_estimate {
    int32_t error;       // enum pose_error
    int32_t has_other;   // 1 if the image has a second pose, 1 degree or more from the first
    int32_t iterations;  // POSIT steps that the branch of `pose` took, at least 1
    struct pose pose;    // the one with the lower rms_px
    struct pose other;
};

struct pose_options {
    struct pose_camera camera;
    float side_mm;           // > 0
    int32_t polish_steps;    // centred: most Gauss-Newton steps on the reprojection, 0 for none
    int32_t max_iterations;  // classic: most POSIT steps of a branch, at least 1
    float stop_error;        // classic: a branch stops when its mean distance over diagonal_px is below
    float diagonal_px;       // classic: the image's diagonal, > 0
};

// Coplanar POSIT on rays turned onto the optical axis, three steps. `vertices_px`: x, y of V1..V4.
void pose_centred(const float vertices_px[8], const struct pose_options *options, struct pose_estimate *estimate);

// Coplanar POSIT as in the paper, section 4.6.1.
void pose_classic(const float vertices_px[8], const struct pose_options *options, struct pose_estimate *estimate);

// A rotation as the unit quaternion w, x, y, z with w >= 0; if w is 0 the first of x, y, z that is not 0 is positive.
void pose_quaternion(const float r[9], float q[4]);

// A rotation as roll, pitch and yaw, rad: turns about the camera's z, x and y axes; r = Rz(roll) Ry(yaw) Rx(pitch).
void pose_angles(const float r[9], float roll_pitch_yaw[3]);

// How near the second pose comes: rms_px of pose over that of other, 0 to 1; 0 if there is no other.
float pose_ambiguity(const struct pose_estimate *estimate);

// Covariance of x, y, z (mm) and of small turns about the camera's x, y and z axes (rad), row by row, in this order.
//
// sigma_px: standard deviation of a vertex's coordinate, px; if it is not positive, the pose's own rms_px decides
// (8 residuals, 6 unknowns). Returns 1, or 0 with a covariance of zeros when it is not finite.
int pose_covariance(const struct pose *pose, const struct pose_options *options, float sigma_px, float covariance[36]);

#endif
