// Clocks of a pose. -DPOSE=pose_centred or -DPOSE=pose_classic says whose, -DCOVARIANCE that those of the covariance
// after it are meant.
#include "pose_job.h"
#include "program.h"

struct answer cold, answers[MOST_MARKERS];
uint32_t empty_clocks;  // that the two readings of the clock take between themselves

#ifdef COVARIANCE
float covariances[MOST_MARKERS][36];
#endif

static void answer(uint32_t number, struct answer *to) {
    const float *const vertices = job.vertices[number];
#ifdef COVARIANCE
    POSE(vertices, &job.options, &to->estimate);
    const uint32_t before = platform_clocks();
    pose_covariance(&to->estimate.pose, &job.options, 0.0f, covariances[number]);
#else
    const uint32_t before = platform_clocks();
    POSE(vertices, &job.options, &to->estimate);
#endif
    to->clocks = platform_clocks() - before;
}

// The first pose finds the caches empty but for what the start has left there; the others follow one another, the first
// once more, so each finds what the one before has left.
void measure(void) {
    answer(0, &cold);
    for (uint32_t number = 0; number < job.count; number++) answer(number, &answers[number]);
    const uint32_t before = platform_clocks();
    empty_clocks = platform_clocks() - before;
}
