// The sensor with a camera and a bus master around it: pixels go in without a pause, and whenever a frame is published
// its results are read through the register bus, as a processor would do it, while the next frame comes in.
//
// registers.h is generated from the register map (sim/engine/sensor.py).

#include <cstdint>
#include <new>
#include <vector>

#include "Vdut.h"
#include "registers.h"

#include "camera.h"

namespace {

constexpr int64_t HELD_PATIENCE = 1'000'000;  // clocks; a full queue of markers takes 300,000

struct Sensor {
    VerilatedContext context;
    Vdut dut{&context, ""};
    int64_t clock = 0;
    Camera camera;
    uint32_t control = 0;
    std::vector<uint32_t> words;   // published frames, each a header and its items
    std::vector<int64_t> markers;  // clock, frame, number of each marker when it was first read from the live window

    void tick() {
        camera.drive(dut, clock);
        dut.clk = 0;
        dut.eval();
        dut.clk = 1;
        dut.eval();
        clock++;
    }

    void write(uint32_t offset, uint32_t value) {
        dut.bus___05Faddress = offset >> 2;
        dut.bus___05Fwrite_data = value;
        dut.bus___05Fwrite = 1;
        tick();
        dut.bus___05Fwrite = 0;
    }

    // Consecutive words, one a clock; data come READ_LATENCY clocks after their address.
    void read(uint32_t offset, int64_t count, std::vector<uint32_t>& into) {
        for (int64_t k = 0; k < count + READ_LATENCY - 1; k++) {
            dut.bus___05Fread = k < count;
            dut.bus___05Faddress = (offset >> 2) + k;
            tick();
            if (k >= READ_LATENCY - 1) into.push_back(dut.bus___05Fread_data);
        }
        dut.bus___05Fread = 0;
    }

    uint32_t read(uint32_t offset) {
        std::vector<uint32_t> one;
        read(offset, 1, one);
        return one[0];
    }

    // False if what is published cannot be had: then the hardware is at fault.
    bool read_published() {
        write(CONTROL, control | CONTROL_HOLD);
        const int64_t start = clock;
        while (!(read(STATUS) & STATUS_HELD)) {
            if (clock - start > HELD_PATIENCE) return false;
        }
        write(IRQ_STATUS, IRQ_PUBLISHED);
        const uint32_t blobs = read(BLOBS), corners = read(CORNERS), markers = read(MARKERS);
        words.insert(words.end(), {read(FRAME), blobs, read(BLOBS_SMALL), corners, markers, read(CANDIDATES_DROPPED),
                                   read(FIRST_PIXEL), read(LAST_PIXEL)});
        read(BLOB_WINDOW, BLOB_WORDS * (blobs & 0xFFFF), words);
        read(CORNER_WINDOW, CORNER_WORDS * (corners & 0xFFFF), words);
        read(MARKER_WINDOW, MARKER_WORDS * (markers & 0xFFFF), words);
        write(CONTROL, control);
        return true;
    }

    void read_markers(uint32_t window, uint32_t frame, uint32_t from, uint32_t count) {
        for (uint32_t k = from; k < count; k++) {
            std::vector<uint32_t> marker;
            read(window + 4 * MARKER_WORDS * k, MARKER_WORDS, marker);
            markers.insert(markers.end(), {clock, frame, static_cast<int64_t>(k)});
            markers.insert(markers.end(), marker.begin(), marker.end());
        }
    }

    void watch_live(uint32_t& seen) {
        const uint32_t live = read(LIVE), number = live & 0xFFFF, before = seen & 0xFFFF;
        // A frame may end right behind its last markers, before a poll tells of them: then they are published.
        if (number != before && (read(FRAME) & 0xFFFF) == before) {
            read_markers(MARKER_WINDOW, before, seen >> 16, read(MARKERS) & 0xFFFF);
        }
        const uint32_t from = number == before ? seen >> 16 : 0, count = live >> 16;
        const size_t kept = markers.size();
        read_markers(LIVE_WINDOW, number, from, count);
        seen = live;
        // The frame ended while they were read: they may be another's, and are published now.
        if (from < count && (read(LIVE) & 0xFFFF) != number) {
            markers.resize(kept);
            seen = from << 16 | number;
        }
    }
};

}  // namespace

extern "C" {

#define EXPORT __attribute__((visibility("default")))

EXPORT Sensor* sensor_new() { return new (std::nothrow) Sensor; }

EXPORT void sensor_delete(Sensor* sensor) { delete sensor; }

EXPORT void sensor_reset(Sensor* sensor) {
    sensor->camera = Camera{};
    sensor->dut.bus___05Fread = sensor->dut.bus___05Fwrite = 0;
    sensor->dut.rst = 1;
    sensor->tick();
    sensor->dut.rst = 0;
}

EXPORT void sensor_write(Sensor* sensor, uint32_t offset, uint32_t value) {
    if (offset == CONTROL) sensor->control = value;
    sensor->write(offset, value);
}

EXPORT uint32_t sensor_read(Sensor* sensor, uint32_t offset) { return sensor->read(offset); }

EXPORT void sensor_idle(Sensor* sensor, int64_t clocks) {
    while (clocks-- > 0) sensor->tick();
}

// Feed pixels and read results until ``publications`` frames are published or ``patience`` clocks passed after the last
// pixel. Returns the number of frames published. With ``live`` the markers are read as they are found instead.
EXPORT int64_t sensor_run(Sensor* sensor, const uint32_t* pixels, int64_t count, const uint8_t* idle, int64_t* fed,
                          int64_t publications, int64_t patience, int live) {
    sensor->camera = Camera{pixels, count, idle, fed};
    sensor->words.clear();
    sensor->markers.clear();
    int64_t published = 0, last = sensor->clock;
    uint32_t seen = sensor->read(LIVE) & 0xFFFF;
    while (!sensor->camera.done() || (published < publications && sensor->clock - last < patience)) {
        if (!sensor->camera.done()) last = sensor->clock;
        if (live) {
            sensor->watch_live(seen);
        } else if (sensor->dut.irq) {
            if (!sensor->read_published()) break;
            published++;
        } else {
            sensor->tick();
        }
    }
    sensor->camera = Camera{};
    return published;
}

EXPORT int64_t sensor_clock(Sensor* sensor) { return sensor->clock; }
EXPORT int64_t sensor_word_count(Sensor* sensor) { return sensor->words.size(); }
EXPORT const uint32_t* sensor_words(Sensor* sensor) { return sensor->words.data(); }
EXPORT int64_t sensor_marker_count(Sensor* sensor) { return sensor->markers.size(); }
EXPORT const int64_t* sensor_markers(Sensor* sensor) { return sensor->markers.data(); }

}  // extern "C"
