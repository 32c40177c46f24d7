// A camera that plays pixels to the design's port `camera`, with idle clocks in between.
#pragma once

#include <cstdint>

struct Camera {
    const uint32_t* pixels = nullptr;
    int64_t count = 0;
    const uint8_t* idle = nullptr;  // clocks before each pixel, or null
    int64_t* fed = nullptr;         // clock of each pixel that is marked sof, in order
    int64_t next = 0;
    int64_t frames = 0;
    int wait = 0;

    Camera() = default;
    Camera(const uint32_t* pixels, int64_t count, const uint8_t* idle, int64_t* fed)
        : pixels(pixels), count(count), idle(idle), fed(fed), wait(idle && count ? idle[0] : 0) {}

    bool done() const { return next == count; }

    template <class Dut>
    void drive(Dut& dut, int64_t clock) {
        bool valid = false;
        if (!done()) {
            if (wait > 0) {
                wait--;
            } else {
                valid = true;
                dut.camera___05Fpayload = pixels[next];
                if (pixels[next] >> SOF_BIT & 1) fed[frames++] = clock;
                next++;
                wait = idle && !done() ? idle[next] : 0;
            }
        }
        dut.camera___05Fvalid = valid;
    }
};
