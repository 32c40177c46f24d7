#include "quad.h"

#include "number.h"

// Rays flatter than this (89.94 degrees off the axis) come from no pinhole camera.
#define MAX_SLOPE 1e3f

// A marker smaller than 1e-5 (0.0064 px at f = 640 px) is rounding.
#define MIN_EXTENT_SQUARED 1e-10f

// A triangle whose height is below this part of its longest side counts as three points in line.
#define MIN_RELATIVE_HEIGHT 1e-3f

enum pose_error check_quad(const float vertices_px[8], const struct pose_camera *camera, struct quad *quad) {
    float scale_x = 1.0f / camera->fx, scale_y = 1.0f / camera->fy;
    for (int n = 0; n < 4; n++) {
        quad->x[n] = (vertices_px[2 * n] - camera->cx) * scale_x;
        quad->y[n] = (vertices_px[2 * n + 1] - camera->cy) * scale_y;
        if (!(pose_abs(quad->x[n]) <= MAX_SLOPE && pose_abs(quad->y[n]) <= MAX_SLOPE)) return POSE_NOT_FINITE;
    }

    float diagonal_squared[2];
    for (int n = 0; n < 2; n++) {
        float x = quad->x[n + 2] - quad->x[n], y = quad->y[n + 2] - quad->y[n];
        quad->diagonal_x[n] = x;
        quad->diagonal_y[n] = y;
        diagonal_squared[n] = x * x + y * y;
    }

    // Edges u and v meet in vertex n + 1; the last v is the first u again.
    int convex = 1;
    float ux = quad->x[1] - quad->x[0], uy = quad->y[1] - quad->y[0];
    float u_squared = ux * ux + uy * uy;
    for (int n = 0; n < 4; n++) {
        int from = (n + 1) & 3, to = (n + 2) & 3;
        float vx = quad->x[to] - quad->x[from], vy = quad->y[to] - quad->y[from];
        float v_squared = vx * vx + vy * vy;
        float turn = ux * vy - uy * vx;
        float longest_squared = pose_max(pose_max(u_squared, v_squared), diagonal_squared[n & 1]);
        if (longest_squared < MIN_EXTENT_SQUARED || pose_abs(turn) < longest_squared * MIN_RELATIVE_HEIGHT)
            return POSE_DEGENERATE;
        if (!(turn > 0.0f)) convex = 0;
        quad->turn[n] = turn;
        ux = vx;
        uy = vy;
        u_squared = v_squared;
    }
    return convex ? POSE_OK : POSE_NOT_CONVEX;
}

void diagonal_parts(const struct quad *quad, float part[2]) {
    // A vertex's distance from the other diagonal is in proportion to its triangle's area with that diagonal.
    part[0] = quad->turn[3] / (quad->turn[3] + quad->turn[1]);
    part[1] = quad->turn[0] / (quad->turn[0] + quad->turn[2]);
}
