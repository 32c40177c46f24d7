#include "linear.h"
#include "number.h"
#include "polish.h"
#include "pose.h"
#include "square.h"

static int in_front(const struct unit_pose *pose) {
    float spoke[4][3];
    spokes(pose->r, spoke);
    for (int n = 0; n < 4; n++)
        if (!(spoke[n][2] + pose->t[2] > MIN_DEPTH)) return 0;
    return 1;
}

static int fill(const struct pose *pose, const struct pose_options *options, float sigma_px, float covariance[36]) {
    float normal[PARAMETERS][PARAMETERS], solution[PARAMETERS];
    float no_residuals[4][2] = {{0.0f}};
    float half_side = options->side_mm * 0.5f;
    float variance = sigma_px > 0.0f ? sigma_px * sigma_px : pose->rms_px * pose->rms_px * 2.0f;
    struct unit_pose unit;
    for (int n = 0; n < 9; n++) unit.r[n] = pose->r[n];
    for (int n = 0; n < 3; n++) unit.t[n] = pose->t_mm[n] / half_side;
    if (!in_front(&unit)) return 0;
    normal_equations(&unit, no_residuals, &options->camera, normal, solution);
    if (!factor_symmetric(normal)) return 0;

    // The step's parameters are the turn and then the shift, ROS's the shift and then the turn.
    const float scales[PARAMETERS] = {half_side, half_side, half_side, 1.0f, 1.0f, 1.0f};
    for (int column = 0; column < PARAMETERS; column++) {
        for (int n = 0; n < PARAMETERS; n++) solution[n] = n == (column + 3) % PARAMETERS ? 1.0f : 0.0f;
        solve_factored(normal, solution);
        for (int row = column; row < PARAMETERS; row++) {
            float value = solution[(row + 3) % PARAMETERS] * variance * scales[row] * scales[column];
            if (!pose_is_finite(value)) return 0;
            covariance[PARAMETERS * row + column] = value;
            covariance[PARAMETERS * column + row] = value;
        }
    }
    return 1;
}

int pose_covariance(const struct pose *pose, const struct pose_options *options, float sigma_px, float covariance[36]) {
    int known = fill(pose, options, sigma_px, covariance);
    for (int n = 0; n < 36 && !known; n++) covariance[n] = 0.0f;
    return known;
}
