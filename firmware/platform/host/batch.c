// Many markers in one call, so that tests of the host library need no call for each.
#include <stddef.h>

#include "lens.h"
#include "pose.h"
#include "vertex.h"

typedef void estimator(const float vertices_px[8], const struct pose_options *options, struct pose_estimate *estimate);

static void batch(estimator *run, size_t count, const float *vertices_px, const struct pose_options *options,
                  struct pose_estimate *estimates) {
    for (size_t n = 0; n < count; n++) run(vertices_px + 8 * n, options, estimates + n);
}

void batch_centred(size_t count, const float *vertices_px, const struct pose_options *options,
                   struct pose_estimate *estimates) {
    batch(pose_centred, count, vertices_px, options, estimates);
}

void batch_classic(size_t count, const float *vertices_px, const struct pose_options *options,
                   struct pose_estimate *estimates) {
    batch(pose_classic, count, vertices_px, options, estimates);
}

void batch_quaternion(size_t count, const float *rotations, float *quaternions) {
    for (size_t n = 0; n < count; n++) pose_quaternion(rotations + 9 * n, quaternions + 4 * n);
}

void batch_angles(size_t count, const float *rotations, float *angles) {
    for (size_t n = 0; n < count; n++) pose_angles(rotations + 9 * n, angles + 3 * n);
}

void batch_covariance(size_t count, const struct pose *poses, const struct pose_options *options, float sigma_px,
                      int *known, float *covariances) {
    for (size_t n = 0; n < count; n++) known[n] = pose_covariance(poses + n, options, sigma_px, covariances + 36 * n);
}

void batch_ambiguity(size_t count, const struct pose_estimate *estimates, float *ambiguities) {
    for (size_t n = 0; n < count; n++) ambiguities[n] = pose_ambiguity(estimates + n);
}

void batch_unbend(size_t count, const float *seen_px, const struct pose_options *options, const struct pose_lens *lens,
                  int are_lines, float *vertices_px) {
    for (size_t n = 0; n < count; n++)
        pose_unbend(seen_px + 8 * n, &options->camera, lens, are_lines, vertices_px + 8 * n);
}

void batch_sigma(size_t count, const uint32_t *qualities, const struct pose_options *options, float *sigmas_px) {
    for (size_t n = 0; n < count; n++) sigmas_px[n] = vertex_sigma(qualities[n], options);
}
