// Roll, pitch and yaw: r = Rz(roll) Ry(yaw) Rx(pitch) in the camera's axes, all 0 for an upright marker that faces the
// camera. Conventions, ranges and errors: firmware/reference/angles.py, whose results these are bit for bit.
#ifndef POSE_ANGLES_H
#define POSE_ANGLES_H

// The angle of the vector (x, y), rad, within 2.1e-6; 0 for (0, 0).
float pose_atan2(float y, float x);

// As pose_angles of pose.h, by the paper's equations 4 and 5: up to 10.3 degrees off.
void pose_angles_paper(const float r[9], float roll_pitch_yaw[3]);

#endif
