#include "lens.h"

#include "number.h"

// Steps of the fixed point; each leaves about 2 |k1| r^2 of the error, at the corner of a wide lens a fifth.
#define STEPS 10

// A ray whose image is further than this from the vertex is none, as slopes: 0.06 px at f = 640 px.
#define TOLERANCE 1e-4f

// What of half a side is fitted (hdl/vision/refining/outline.py), and 1/sqrt(3): where the least squares' line of a
// parabola crosses it.
#define FITTED 0.9375f
#define TRIMMED_PX 2.0f
#define CROSSING 0.57735027f

struct bend {
    float scale, shift_x, shift_y;
};

static struct bend bend_at(const struct pose_lens *lens, float x, float y) {
    float square = x * x + y * y, product = x * y * 2.0f;
    return (struct bend){
        .scale = (square * lens->k2 + lens->k1) * square + 1.0f,
        .shift_x = product * lens->p1 + (x * x * 2.0f + square) * lens->p2,
        .shift_y = (y * y * 2.0f + square) * lens->p1 + product * lens->p2,
    };
}

static void unbend(float seen_u, float seen_v, const struct pose_camera *camera, const struct pose_lens *lens,
                   float point_px[2]) {
    float seen_x = (seen_u - camera->cx) * (1.0f / camera->fx), seen_y = (seen_v - camera->cy) * (1.0f / camera->fy);
    float x = seen_x, y = seen_y;
    POSE_ROLLED
    for (int step = 0; step < STEPS; step++) {
        struct bend bend = bend_at(lens, x, y);
        float inverse = 1.0f / bend.scale;
        x = (seen_x - bend.shift_x) * inverse;
        y = (seen_y - bend.shift_y) * inverse;
    }
    struct bend bend = bend_at(lens, x, y);
    float wrong_x = x * bend.scale + bend.shift_x - seen_x, wrong_y = y * bend.scale + bend.shift_y - seen_y;
    int is_ray = bend.scale > 0.0f && pose_abs(wrong_x) < TOLERANCE && pose_abs(wrong_y) < TOLERANCE;
    point_px[0] = is_ray ? x * camera->fx + camera->cx : __builtin_nanf("");
    point_px[1] = is_ray ? y * camera->fy + camera->cy : __builtin_nanf("");
}

// Two points of the side that starts at a vertex.
static void side_points(const float seen_px[8], int side, const struct pose_camera *camera,
                        const struct pose_lens *lens, float point_px[2][2]) {
    const float *start = seen_px + 2 * side, *end = seen_px + 2 * ((side + 1) & 3);
    float half_x = (end[0] - start[0]) * 0.5f, half_y = (end[1] - start[1]) * 0.5f;
    float middle_x = start[0] + half_x, middle_y = start[1] + half_y;
    // Of half a side all is fitted but a sixteenth and two rows or columns.
    float part = (FITTED - TRIMMED_PX / pose_max(pose_abs(half_x), pose_abs(half_y))) * CROSSING;
    unbend(middle_x - half_x * part, middle_y - half_y * part, camera, lens, point_px[0]);
    unbend(middle_x + half_x * part, middle_y + half_y * part, camera, lens, point_px[1]);
}

// Where two lines meet, reckoned from `near`, so that no digits are lost.
static void meet(float one[2][2], float other[2][2], const float near[2], float vertex_px[2]) {
    float x = one[0][0] - near[0], y = one[0][1] - near[1];
    float along_x = one[1][0] - one[0][0], along_y = one[1][1] - one[0][1];
    float across_x = other[1][0] - other[0][0], across_y = other[1][1] - other[0][1];
    float gap_x = other[0][0] - one[0][0], gap_y = other[0][1] - one[0][1];
    float part = (gap_x * across_y - gap_y * across_x) / (along_x * across_y - along_y * across_x);
    vertex_px[0] = x + along_x * part + near[0];
    vertex_px[1] = y + along_y * part + near[1];
}

void pose_unbend(const float seen_px[8], const struct pose_camera *camera, const struct pose_lens *lens, int are_lines,
                 float vertices_px[8]) {
    float point_px[4][2][2];
    for (int n = 0; n < 4; n++) unbend(seen_px[2 * n], seen_px[2 * n + 1], camera, lens, vertices_px + 2 * n);
    if (!are_lines) return;
    for (int n = 0; n < 4; n++) side_points(seen_px, n, camera, lens, point_px[n]);
    for (int n = 0; n < 4; n++) {
        const float near[2] = {vertices_px[2 * n], vertices_px[2 * n + 1]};
        meet(point_px[(n + 3) & 3], point_px[n], near, vertices_px + 2 * n);
    }
}
