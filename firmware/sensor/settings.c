// The defaults: the camera of the examples, 640 x 480 with a focal length of 640 px, and the paper's marker.
#include "settings.h"

__attribute__((section(".settings"), used)) const struct settings settings = {
    .pose =
        {
            .camera = {.fx = 640.0f, .fy = 640.0f, .cx = 319.5f, .cy = 239.5f},
            .side_mm = 113.0f,
            .polish_steps = 0,
            .max_iterations = 30,
            .stop_error = 1e-5f,
            .diagonal_px = 800.0f,
        },
    .uart_divisor = 25,            // 2 Mbaud at 50 MHz
    .tick_clocks = 500000,         // 10 ms at 50 MHz
    .watchdog_clocks = 100000000,  // 2 s
    .display_ticks = 20,
    .status_ticks = 100,
    .covariance = 0,
};
