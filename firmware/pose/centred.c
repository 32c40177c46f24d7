// Coplanar POSIT on turned rays; the derivation is in firmware/reference/centred.py.
#include "estimate.h"
#include "number.h"
#include "polish.h"
#include "posit.h"
#include "quad.h"
#include "square.h"

#define STEPS 3

// A vertex's depth against its distance from the axis in the turned frame: 89.94 degrees off the ray to the centre.
#define MIN_DEPTH_RATIO 1e-3f

// 1/Z0^2 of a marker 1e7 half sides away; a smaller one comes from rounding, and its squares from underflow.
#define MIN_SCALE_SQUARED 1e-14f

// The smallest rotation that takes the marker's centre onto the optical axis; (a, b, c) is the ray to the centre.
struct axis {
    float a, b, c, d, length;  // d = 1 / (1 + c), length = 1 / c
};

// A turned diagonal (x, y); its factor is mean + slope p, whose square has these weights in c, s, |I0|^2 + |J0|^2.
struct diagonal {
    float x, y, mean, slope, c, s, n;
};

// A step's result; factor and p are those of the two diagonals, the vertices' depth ratios 1 - p and 1 + p.
struct step {
    float factor[2], p[2], lam, mu, depth;
};

static void axis_through(const struct quad *quad, float part, struct axis *axis) {
    float x = quad->x[0] + quad->diagonal_x[0] * part, y = quad->y[0] + quad->diagonal_y[0] * part;
    axis->length = pose_sqrt(x * x + y * y + 1.0f);
    axis->c = 1.0f / axis->length;
    axis->a = x * axis->c;
    axis->b = y * axis->c;
    axis->d = 1.0f / (1.0f + axis->c);
}

// Turn the diagonal (x, y, 0), `p`: its first p; returns 0 if a vertex is square to the ray to the centre, else 1.
static int turn_diagonal(const struct axis *axis, float x, float y, float part, struct diagonal *turned, float *p) {
    float z = axis->a * x + axis->b * y;
    float w = z * axis->d;
    x -= axis->a * w;
    y -= axis->b * w;
    float rest = 1.0f - part;
    float first_depth = axis->length - part * z, second_depth = axis->length + rest * z;
    float least = (pose_abs(x) + pose_abs(y)) * MIN_DEPTH_RATIO;
    if (!(first_depth > least && second_depth > least)) return 0;
    float first = part / first_depth * 0.5f, second = rest / second_depth * 0.5f;
    float xx = x * x, yy = y * y;
    turned->x = x;
    turned->y = y;
    turned->mean = first + second;
    turned->slope = second - first;
    *p = -(turned->slope / turned->mean);
    turned->c = (yy - xx) * 0.5f;
    turned->s = -(x * y);
    turned->n = (yy + xx) * 0.5f;
    return 1;
}

static void mirror(struct step *step) {
    step->lam = -step->lam;
    step->mu = -step->mu;
    step->p[0] = -step->p[0];
    step->p[1] = -step->p[1];
}

// One step of POSIT from the depth ratios of `step`, into it; returns 0 if the rows vanish, else 1.
static int take_step(const struct diagonal diagonal[2], struct step *step) {
    const struct diagonal *u = &diagonal[0], *v = &diagonal[1];
    float alpha = u->mean + step->p[0] * u->slope, beta = v->mean + step->p[1] * v->slope;
    float a = alpha * alpha, b = beta * beta;
    float c = a * u->c + b * v->c, s = a * u->s + b * v->s;
    float r = pose_sqrt(c * c + s * s);
    float scale_squared = (a * u->n + b * v->n + r) * 0.5f;
    if (!(scale_squared > MIN_SCALE_SQUARED)) return 0;
    float depth = 1.0f / pose_sqrt(scale_squared);
    float lam, mu;
    complex_root(c, s, r, &lam, &mu);
    step->p[0] = beta * (v->x * mu - lam * v->y) * depth;
    step->p[1] = alpha * (lam * u->y - u->x * mu) * depth;
    step->factor[0] = alpha;
    step->factor[1] = beta;
    step->lam = lam;
    step->mu = mu;
    step->depth = depth;
    return 1;
}

// From a branch's first step to its last, keeping the sign of the root; returns 0 if a vertex comes behind the camera.
static int follow_branch(const struct diagonal diagonal[2], struct step *step) {
    POSE_ROLLED
    for (int n = 1; n < STEPS; n++) {
        if (!(pose_abs(step->p[0]) < 1.0f && pose_abs(step->p[1]) < 1.0f)) return 0;
        float lam = step->lam, mu = step->mu;
        if (!take_step(diagonal, step)) return 0;
        if (step->lam * lam + step->mu * mu < 0.0f) mirror(step);
    }
    return 1;
}

// A branch's last step as a pose in the camera's own frame.
static void to_unit_pose(const struct axis *axis, const struct diagonal diagonal[2], const struct step *step,
                         struct unit_pose *pose) {
    float turned[2][3];  // spokes to V3 and V4
    for (int n = 0; n < 2; n++) {
        float factor = step->factor[n] * step->depth;
        float x = factor * diagonal[n].x, y = factor * diagonal[n].y, z = step->p[n] * step->depth;
        float m = axis->a * x + axis->b * y;
        float h = z - m * axis->d;
        turned[n][0] = x + axis->a * h;
        turned[n][1] = y + axis->b * h;
        turned[n][2] = axis->c * z - m;
    }
    float *r = pose->r;
    for (int n = 0; n < 3; n++) {
        r[3 * n] = (turned[0][n] - turned[1][n]) * 0.5f;
        r[3 * n + 1] = (turned[0][n] + turned[1][n]) * 0.5f;
    }
    r[2] = r[3] * r[7] - r[6] * r[4];
    r[5] = r[6] * r[1] - r[0] * r[7];
    r[8] = r[0] * r[4] - r[3] * r[1];
    pose->t[0] = axis->a * step->depth;
    pose->t[1] = axis->b * step->depth;
    pose->t[2] = axis->c * step->depth;
}

static void find_poses(const struct quad *quad, const struct pose_options *options, struct found *found) {
    float part[2];
    struct axis axis;
    struct diagonal diagonal[2];
    struct step first;
    found->count = 0;
    diagonal_parts(quad, part);
    axis_through(quad, part[0], &axis);
    for (int n = 0; n < 2; n++)
        if (!turn_diagonal(&axis, quad->diagonal_x[n], quad->diagonal_y[n], part[n], &diagonal[n], &first.p[n])) return;
    if (!take_step(diagonal, &first)) return;
    float half_side = options->side_mm * 0.5f;
    for (int branch = 0; branch < 2; branch++) {
        struct step step = first;
        struct unit_pose unit;
        if (branch) mirror(&step);
        if (!follow_branch(diagonal, &step)) continue;
        to_unit_pose(&axis, diagonal, &step, &unit);
        float rms = polish(&unit, quad, &options->camera, options->polish_steps);
        struct pose *pose = &found->pose[found->count];
        for (int n = 0; n < 9; n++) pose->r[n] = unit.r[n];
        for (int n = 0; n < 3; n++) pose->t_mm[n] = half_side * unit.t[n];
        pose->rms_px = rms;
        found->iterations[found->count] = STEPS;
        found->count += is_valid(pose);
    }
}

void pose_centred(const float vertices_px[8], const struct pose_options *options, struct pose_estimate *estimate) {
    struct quad quad;
    struct found found;
    enum pose_error error = check_quad(vertices_px, &options->camera, &quad);
    if (error != POSE_OK) {
        answer_error(error, estimate);
        return;
    }
    find_poses(&quad, options, &found);
    answer_found(&found, estimate);
}
