// The whole system with a camera, and a host that loads the processor's memory and reads what it likes. Pixels and
// processor run together; what the firmware sends is kept, byte by byte with its clock.
//
// registers.h is generated from the register map (sim/engine/system.py).

#include <cstdint>
#include <cstdio>
#include <new>
#include <string>
#include <vector>

#include "Vdut.h"
#include "registers.h"

#include "camera.h"

namespace {

constexpr int64_t ACCESS_PATIENCE = 100'000;  // clocks; the processor can keep the host waiting, but not for long

struct System {
    VerilatedContext context;
    Vdut dut{&context, ""};
    int64_t clock = 0;
    Camera camera;
    bool failed = false;
    std::string line;          // that is being sent
    int64_t markers_left = 0;  // whose sentences belong to the frame that is being told
    int64_t frames_told = 0;
    std::vector<uint8_t> sent;
    std::vector<int64_t> sent_clock, published_clock;
    bool irq = false;

    // Frames are told by `$RPFRM,frame,time,markers,...` and as many `$RPPOS`.
    void end_line() {
        long markers = 0;
        if (std::sscanf(line.c_str(), "$RPFRM,%*u,%*u.%*u,%ld", &markers) == 1) {
            markers_left = markers;
            if (!markers_left) frames_told++;
        } else if (line.rfind("$RPPOS", 0) == 0 && markers_left > 0 && --markers_left == 0) {
            frames_told++;
        }
        line.clear();
    }

    void tick() {
        camera.drive(dut, clock);
        dut.clk = 0;
        dut.eval();
        dut.clk = 1;
        dut.eval();
        clock++;
        if (dut.sent___05Fvalid) {
            sent.push_back(dut.sent___05Fpayload);
            sent_clock.push_back(clock);
            line.push_back(static_cast<char>(dut.sent___05Fpayload));
            if (dut.sent___05Fpayload == '\n') end_line();
        }
        if (dut.irq && !irq) published_clock.push_back(clock);
        irq = dut.irq;
    }

    uint32_t access(uint32_t address, bool write, uint32_t data) {
        dut.request = 1;
        dut.write = write;
        dut.address = address;
        dut.write_data = data;
        tick();
        dut.request = 0;
        for (int64_t start = clock; !dut.done; tick()) {
            if (clock - start > ACCESS_PATIENCE) {
                failed = true;
                return 0;
            }
        }
        return dut.read_data;
    }
};

}  // namespace

extern "C" {

#define EXPORT __attribute__((visibility("default")))

EXPORT System* system_new() { return new (std::nothrow) System; }

EXPORT void system_delete(System* system) { delete system; }

// Pulse the reset, and leave the processor halted or not.
EXPORT void system_reset(System* system, int halt) {
    system->camera = Camera{};
    system->dut.request = 0;
    system->dut.halt = halt;
    system->dut.rst = 1;
    system->tick();
    system->dut.rst = 0;
    system->tick();
}

EXPORT void system_halt(System* system, int halt) { system->dut.halt = halt; }

EXPORT void system_write(System* system, uint32_t address, const uint32_t* words, int64_t count) {
    for (int64_t k = 0; k < count; k++) system->access(address + 4 * k, true, words[k]);
}

EXPORT void system_read(System* system, uint32_t address, uint32_t* words, int64_t count) {
    for (int64_t k = 0; k < count; k++) words[k] = system->access(address + 4 * k, false, 0);
}

EXPORT void system_idle(System* system, int64_t clocks) {
    while (clocks-- > 0) system->tick();
}

// Feed pixels, and go on until the firmware has told of `frames` frames or `patience` clocks passed after the last
// pixel. Returns the number of frames that were told.
EXPORT int64_t system_run(System* system, const uint32_t* pixels, int64_t count, const uint8_t* idle, int64_t* fed,
                          int64_t frames, int64_t patience) {
    system->camera = Camera{pixels, count, idle, fed};
    system->frames_told = 0;
    int64_t last = system->clock;
    while (!system->camera.done() || (system->frames_told < frames && system->clock - last < patience)) {
        if (!system->camera.done()) last = system->clock;
        system->tick();
    }
    system->camera = Camera{};
    return system->frames_told;
}

EXPORT void system_forget(System* system) {
    system->sent.clear();
    system->sent_clock.clear();
    system->published_clock.clear();
}

EXPORT int64_t system_clock(System* system) { return system->clock; }
EXPORT int system_failed(System* system) { return system->failed; }
EXPORT int64_t system_sent_count(System* system) { return system->sent.size(); }
EXPORT const uint8_t* system_sent(System* system) { return system->sent.data(); }
EXPORT const int64_t* system_sent_clock(System* system) { return system->sent_clock.data(); }
EXPORT int64_t system_published_count(System* system) { return system->published_clock.size(); }
EXPORT const int64_t* system_published_clock(System* system) { return system->published_clock.data(); }

}  // extern "C"
