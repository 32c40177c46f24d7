// How well the hardware knows a vertex, from the quality word of its marker (hdl/registers.rdl).
#ifndef POSE_VERTEX_H
#define POSE_VERTEX_H

#include "pose.h"

#define QUALITY_REFINED 0x01000000u

// Standard deviation of a vertex's coordinate, px: what pose_covariance wants. Polished poses scatter less.
float vertex_sigma(uint32_t quality, const struct pose_options *options);

#endif
