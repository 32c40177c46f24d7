#include "polish.h"

#include "number.h"

// Turn a rotation by the unit quaternion along (1, w/2): orthonormal for a step of any length.
static void rotate(float r[9], float wx, float wy, float wz) {
    float s = 1.0f / pose_sqrt((wx * wx + wy * wy + wz * wz) * 0.25f + 1.0f);
    float half = s * 0.5f;
    float a = wx * half, b = wy * half, c = wz * half;
    const float turn[3][3] = {
        {1.0f - (b * b + c * c) * 2.0f, (a * b - s * c) * 2.0f, (a * c + s * b) * 2.0f},
        {(a * b + s * c) * 2.0f, 1.0f - (a * a + c * c) * 2.0f, (b * c - s * a) * 2.0f},
        {(a * c - s * b) * 2.0f, (b * c + s * a) * 2.0f, 1.0f - (a * a + b * b) * 2.0f},
    };
    for (int column = 0; column < 3; column++) {
        float u = r[column], v = r[3 + column], w = r[6 + column];
        for (int row = 0; row < 3; row++) r[3 * row + column] = turn[row][0] * u + turn[row][1] * v + turn[row][2] * w;
    }
}

void normal_equations(const struct unit_pose *pose, float difference[4][2], const struct pose_camera *camera,
                      float normal[PARAMETERS][PARAMETERS], float right[PARAMETERS]) {
    float spoke[4][3];
    spokes(pose->r, spoke);
    for (int m = 0; m < PARAMETERS; m++) {
        right[m] = 0.0f;
        for (int n = 0; n <= m; n++) normal[m][n] = 0.0f;
    }
    for (int vertex = 0; vertex < 4; vertex++) {
        float px = spoke[vertex][0], py = spoke[vertex][1], pz = spoke[vertex][2];
        float scale = 1.0f / (pz + pose->t[2]);
        float x = (px + pose->t[0]) * scale, y = (py + pose->t[1]) * scale;
        float u = camera->fx * scale, v = camera->fy * scale;
        // d(vertex) = w x spoke + shift, then the derivative of the division by the depth.
        const float rows[2][PARAMETERS] = {
            {-(u * x * py), u * (pz + x * px), -(u * py), u, 0.0f, -(u * x)},
            {-(v * (pz + y * py)), v * y * px, v * px, 0.0f, v, -(v * y)},
        };
        const float values[2] = {camera->fx * difference[vertex][0], camera->fy * difference[vertex][1]};
        for (int axis = 0; axis < 2; axis++) {
            const float *row = rows[axis];
            for (int m = 0; m < PARAMETERS; m++) {
                right[m] += row[m] * values[axis];
                for (int n = 0; n <= m; n++) normal[m][n] += row[m] * row[n];
            }
        }
    }
}

// One full step from a pose in front of the camera; returns 0 if the equations are singular, else 1.
static int gauss_newton_step(struct unit_pose *pose, const struct quad *quad, const struct pose_camera *camera) {
    float difference[4][2], normal[PARAMETERS][PARAMETERS], step[PARAMETERS];
    if (!residuals(pose, quad, difference)) return 0;
    normal_equations(pose, difference, camera, normal, step);
    if (!factor_symmetric(normal)) return 0;
    solve_factored(normal, step);
    rotate(pose->r, step[0], step[1], step[2]);
    for (int n = 0; n < 3; n++) pose->t[n] += step[3 + n];
    return 1;
}

float polish(struct unit_pose *pose, const struct quad *quad, const struct pose_camera *camera, int32_t steps) {
    float rms = rms_px(pose, quad, camera);
    for (; steps > 0; steps--) {
        struct unit_pose candidate = *pose;
        if (!gauss_newton_step(&candidate, quad, camera)) break;
        float candidate_rms = rms_px(&candidate, quad, camera);
        if (!(candidate_rms < rms))  // a step that does not lower the rms is not taken
            break;
        *pose = candidate;
        rms = candidate_rms;
    }
    return rms;
}
