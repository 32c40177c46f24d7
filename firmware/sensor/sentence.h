// The lines on the serial port, in the manner of NMEA 0183: '$', fields between commas, '*', the XOR of everything
// between '$' and '*' as two hexadecimal digits, CR, LF.
//
//   $RPFRM,frame,time,markers,skipped*hh
//   $RPPOS,frame,time,marker,error,x,y,z,qw,qx,qy,qz,rms,ambiguity*hh
//   $RPCOV,frame,time,marker,c11,c12..c16,c22..c66*hh
//   $RPSTA,time,frames,skipped,cut,lost,traps,restarts*hh
//   $RPTRP,cause,address,value*hh
//
// frame: number of the frame. time: of its first pixel, in s since the start. markers: how many $RPPOS of this frame
// follow. skipped: complete frames since the start of which there is no $RPFRM; after a restart, all before it.
// marker: from 0. error: 0, or a number of enum pose_error; then the fields behind it are empty. x, y, z: the marker's
// centre in the camera's axes, mm. qw to qz: unit quaternion, marker to camera. rms: of the reprojection, px.
// ambiguity: that of the pose over that of the other one, 0 (certain) to 1 (either).
// c11 to c66: upper triangle of the pose's covariance, row by row, in ROS's order (x, y, z in mm, small turns about the
// camera's x, y, z in rad), each the bits of a float32 as 8 hexadecimal digits; all 0 where it is not known. These
// lines come if settings.covariance is 1, each behind its $RPPOS, none where that tells an error. frames: complete
// frames; cut: frames that were broken, and so not taken; lost: bytes that the UART dropped; traps: see $RPTRP;
// restarts: by the watchdog; all since the start. cause, address, value: hexadecimal, as the RISC-V CSRs mcause, mepc,
// mtval. After a restart of the program the time begins at the last moment when the sensor's TIME was 0, up to 86 s
// ago.
#ifndef RASTERPOSE_SENTENCE_H
#define RASTERPOSE_SENTENCE_H

#include <stdint.h>

#include "report.h"

enum { SENTENCE_LENGTH = 256 };  // enough for every line, with the final 0

struct moment {
    uint32_t seconds, microseconds;
};

struct status {
    uint32_t frames, skipped, cut, lost, traps, restarts;
};

// Each writes a line with a final 0 and returns its length.
int sentence_frame(char *line, const struct frame_report *frame, struct moment time);
int sentence_pose(char *line, uint32_t frame, struct moment time, uint32_t number, const struct marker_report *marker);
int sentence_covariance(char *line, uint32_t frame, struct moment time, uint32_t number, const float covariance[36]);
int sentence_status(char *line, struct moment time, const struct status *status);
int sentence_trap(char *line, uint32_t cause, uint32_t address, uint32_t value);

#endif
