// Roll, pitch and yaw of a rotation; see angles.h.
#include "angles.h"

#include "approximations.h"
#include "number.h"
#include "pose.h"

// Below this cos(yaw)^2 rounding decides roll and pitch.
#define LOCK 1e-8f

// What equation 4 takes for pi/2, so that the arc sine of 0 is 0.
#define ACOS_OF_ZERO 1.5707963f

float pose_atan2(float y, float x) {
    float across = pose_abs(y), along = pose_abs(x);
    float low = across > along ? along : across, high = across > along ? across : along;
    if (high == 0.0f) return high;
    float ratio = low / high, q = ratio * ratio;
    // Minimax for atan(ratio) on [0, 1].
    float angle = 0.052535143f + q * -0.01167932f;
    angle = -0.11631141f + q * angle;
    angle = 0.19348912f + q * angle;
    angle = -0.33261392f + q * angle;
    angle = ratio * (0.99997693f + q * angle);
    if (across > along) angle = POSE_HALF_PI - angle;
    if (x < 0.0f) angle = POSE_PI - angle;
    return y < 0.0f ? -angle : angle;
}

void pose_angles(const float r[9], float roll_pitch_yaw[3]) {
    float cosine_squared = r[0] * r[0] + r[3] * r[3];
    roll_pitch_yaw[2] = pose_atan2(-r[6], pose_sqrt(cosine_squared));
    if (cosine_squared > LOCK) {
        roll_pitch_yaw[0] = pose_atan2(r[3], r[0]);
        roll_pitch_yaw[1] = pose_atan2(r[7], r[8]);
    } else {
        roll_pitch_yaw[0] = pose_atan2(-r[1], r[4]);
        roll_pitch_yaw[1] = 0.0f;
    }
}

static float atan2_taylor(float y, float x) {
    if (x == 0.0f) {
        if (y == 0.0f) return 0.0f;
        return y > 0.0f ? POSE_HALF_PI : -POSE_HALF_PI;
    }
    float angle = pose_atan_taylor(y / x);
    if (x < 0.0f) return y < 0.0f ? angle - POSE_PI : angle + POSE_PI;
    return angle;
}

void pose_angles_paper(const float r[9], float roll_pitch_yaw[3]) {
    float sine = -r[6];
    if (sine < -1.0f) sine = -1.0f;
    if (sine > 1.0f) sine = 1.0f;
    roll_pitch_yaw[2] = ACOS_OF_ZERO - pose_acos_cubic(sine);
    if (r[0] * r[0] + r[3] * r[3] > LOCK) {
        roll_pitch_yaw[0] = atan2_taylor(r[3], r[0]);
        roll_pitch_yaw[1] = atan2_taylor(r[7], r[8]);
    } else {
        roll_pitch_yaw[0] = atan2_taylor(-r[1], r[4]);
        roll_pitch_yaw[1] = 0.0f;
    }
}
