// Coplanar POSIT as the paper runs it: two branches, each until its error E is small or the limit is met.
//
// In the paper's units, px and mm. Statement by statement firmware/reference/classic.py, whose results these are
// bit for bit, but for POSE_LIBRARY.
#include "approximations.h"
#include "estimate.h"
#include "functions.h"
#include "number.h"
#include "posit.h"
#include "quad.h"

// What the camera sees: V1..V4 less the principal point, px, y stretched to the focal length of x.
struct view {
    float x[4], y[4];
    float focal;     // px
    float aspect;    // what a distance in y is multiplied by to have px again
    float half;      // half the marker's side, mm
    float per_side;  // 1 over twice the side, 1/mm
};

struct candidate {
    struct pose pose;   // its rms_px not yet known
    float distance;     // mean reprojection distance, px; infinite: a vertex behind the camera, or out of range
    float mean_square;  // of the same, px^2
};

// (lambda + i mu)^2 = c + i s
#if POSE_FUNCTIONS == POSE_EXACT
static void both_parts(float c, float s, float *lambda, float *mu) {
    complex_root(c, s, POSE_SQRT(c * c + s * s), lambda, mu);
}
#else
static void both_parts(float c, float s, float *lambda, float *mu) {
    float radius = POSE_SQRT(POSE_SQRT(c * c + s * s)), angle;
    if (c == 0.0f) {
        angle = s >= 0.0f ? POSE_HALF_PI : -POSE_HALF_PI;
    } else {
        angle = POSE_ATAN(s / c);
        if (c < 0.0f) angle += POSE_PI;
    }
    angle *= 0.5f;
    *lambda = radius * POSE_COS(angle);
    *mu = radius * POSE_SIN(angle);
}
#endif

// One coordinate of the vectors from the marker's centre to V1..V4, in the camera's axes; a row of the rotation.
static void spokes_along(const float row[3], float half, float along[4]) {
    float third = (row[0] + row[1]) * half, fourth = (row[1] - row[0]) * half;
    along[0] = -third;
    along[1] = -fourth;
    along[2] = third;
    along[3] = fourth;
}

// Compares the image with the pose's.
static void reproject(const struct view *view, struct candidate *candidate) {
    const struct pose *pose = &candidate->pose;
    float px[4], py[4], pz[4], total = 0.0f, squares = 0.0f;
    candidate->distance = __builtin_inff();
    spokes_along(pose->r, view->half, px);
    spokes_along(pose->r + 3, view->half, py);
    spokes_along(pose->r + 6, view->half, pz);
    for (int n = 0; n < 4; n++) {
        float depth = pz[n] + pose->t_mm[2];
        if (!(depth > 0.0f))  // or NaN, where the rows vanish
            return;
        float magnification = view->focal / depth;
        float du = view->x[n] - (px[n] + pose->t_mm[0]) * magnification;
        float dv = (view->y[n] - (py[n] + pose->t_mm[1]) * magnification) * view->aspect;
        float square = du * du + dv * dv;
        squares += square;
        total += POSE_SQRT(square);
    }
    if (!pose_is_finite(total))  // the fast root of infinity is -infinity
        return;
    candidate->distance = total * 0.25f;
    candidate->mean_square = squares * 0.25f;
}

// The two poses that explain the image under the vertices' depth ratios Z_i / Z0, and how well.
//
// I = (ix, iy, lam) and J = (jx, jy, mu), the pose's first two rows in px per mm, are orthogonal and of equal length
// focal / Z0. The other sign of lam and mu gives the second pose.
static void take_step(const struct view *view, const float ratios[4], struct candidate candidates[2]) {
    float *r = candidates[0].pose.r, *t = candidates[0].pose.t_mm, lam, mu;
    float x1 = view->x[0] * ratios[0], y1 = view->y[0] * ratios[0];
    float third_x = view->x[2] * ratios[2] - x1, fourth_x = view->x[3] * ratios[3] - view->x[1] * ratios[1];
    float third_y = view->y[2] * ratios[2] - y1, fourth_y = view->y[3] * ratios[3] - view->y[1] * ratios[1];
    float ix = (third_x - fourth_x) * view->per_side, iy = (third_x + fourth_x) * view->per_side;
    float jx = (third_y - fourth_y) * view->per_side, jy = (third_y + fourth_y) * view->per_side;
    float i_squared = ix * ix + iy * iy, j_squared = jx * jx + jy * jy;
    both_parts(j_squared - i_squared, (ix * jx + iy * jy) * -2.0f, &lam, &mu);
    float norm_i = POSE_SQRT(i_squared + lam * lam), norm_j = POSE_SQRT(j_squared + mu * mu);
    float scale_i = 1.0f / norm_i, scale_j = 1.0f / norm_j;
    r[0] = ix * scale_i;
    r[1] = iy * scale_i;
    r[2] = lam * scale_i;
    r[3] = jx * scale_j;
    r[4] = jy * scale_j;
    r[5] = mu * scale_j;
    r[6] = r[1] * r[5] - r[2] * r[4];
    r[7] = r[2] * r[3] - r[0] * r[5];
    r[8] = r[0] * r[4] - r[1] * r[3];
    float mm_per_px = 2.0f / (norm_i + norm_j);
    t[0] = x1 * mm_per_px + (r[0] + r[1]) * view->half;
    t[1] = y1 * mm_per_px + (r[3] + r[4]) * view->half;
    t[2] = view->focal * mm_per_px;

    candidates[1] = candidates[0];
    float *mirrored = candidates[1].pose.r;
    mirrored[2] = -r[2];
    mirrored[5] = -r[5];
    mirrored[6] = -r[6];
    mirrored[7] = -r[7];
    reproject(view, &candidates[0]);
    reproject(view, &candidates[1]);
}

// Further steps of a branch, each keeping the better of its two poses; returns their number with the first.
static int32_t follow_branch(const struct view *view, const struct pose_options *options, struct candidate *candidate) {
    float stop_px = options->stop_error * options->diagonal_px;
    int32_t iterations = 1;
    while (candidate->distance >= stop_px && pose_is_finite(candidate->distance) &&
           iterations < options->max_iterations) {
        struct candidate candidates[2];
        float ratios[4], scale = 1.0f / candidate->pose.t_mm[2];
        spokes_along(candidate->pose.r + 6, view->half, ratios);
        for (int n = 0; n < 4; n++) ratios[n] = 1.0f + ratios[n] * scale;
        take_step(view, ratios, candidates);
        *candidate = candidates[candidates[1].distance < candidates[0].distance];
        iterations++;
    }
    return iterations;
}

void pose_classic(const float vertices_px[8], const struct pose_options *options, struct pose_estimate *estimate) {
    const struct pose_camera *camera = &options->camera;
    static const float orthographic[4] = {1.0f, 1.0f, 1.0f, 1.0f};
    struct quad quad;
    struct view view;
    struct candidate candidates[2];

    enum pose_error error = check_quad(vertices_px, camera, &quad);
    if (error != POSE_OK) {
        answer_error(error, estimate);
        return;
    }
    float stretch = camera->fx / camera->fy;
    for (int n = 0; n < 4; n++) {
        view.x[n] = vertices_px[2 * n] - camera->cx;
        view.y[n] = (vertices_px[2 * n + 1] - camera->cy) * stretch;
    }
    view.focal = camera->fx;
    view.aspect = camera->fy / camera->fx;
    view.half = options->side_mm * 0.5f;
    view.per_side = 1.0f / (view.half * 4.0f);

    take_step(&view, orthographic, candidates);
    struct found found = {.count = 0};
    for (int n = 0; n < 2; n++) {
        struct pose *pose = &candidates[n].pose;
        int32_t iterations = follow_branch(&view, options, &candidates[n]);
        if (!pose_is_finite(candidates[n].distance)) continue;
        pose->rms_px = POSE_SQRT(candidates[n].mean_square);
        if (is_valid(pose)) {
            found.pose[found.count] = *pose;
            found.iterations[found.count++] = iterations;
        }
    }
    answer_found(&found, estimate);
}
