#include "square.h"

#include "number.h"

void spokes(const float r[9], float spoke[4][3]) {
    for (int axis = 0; axis < 3; axis++) {
        float third = r[3 * axis] + r[3 * axis + 1];
        float fourth = r[3 * axis + 1] - r[3 * axis];
        spoke[0][axis] = -third;
        spoke[1][axis] = -fourth;
        spoke[2][axis] = third;
        spoke[3][axis] = fourth;
    }
}

int residuals(const struct unit_pose *pose, const struct quad *quad, float difference[4][2]) {
    float spoke[4][3];
    spokes(pose->r, spoke);
    for (int n = 0; n < 4; n++) {
        float depth = spoke[n][2] + pose->t[2];
        if (!(depth > MIN_DEPTH)) return 0;
        float scale = 1.0f / depth;
        difference[n][0] = quad->x[n] - (spoke[n][0] + pose->t[0]) * scale;
        difference[n][1] = quad->y[n] - (spoke[n][1] + pose->t[1]) * scale;
    }
    return 1;
}

float rms_px(const struct unit_pose *pose, const struct quad *quad, const struct pose_camera *camera) {
    float difference[4][2];
    if (!residuals(pose, quad, difference)) return __builtin_inff();
    float sum_x = 0.0f, sum_y = 0.0f;
    for (int n = 0; n < 4; n++) {
        sum_x += difference[n][0] * difference[n][0];
        sum_y += difference[n][1] * difference[n][1];
    }
    return pose_sqrt((camera->fx * camera->fx * sum_x + camera->fy * camera->fy * sum_y) * 0.25f);
}
