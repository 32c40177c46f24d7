// Plays a schedule into a Verilated block and keeps what comes out, without leaving C++ for a single clock.
//
// ports.h is generated for each block (sim/engine/stream.py). It names the Verilated class Dut and gives
// INPUTS, OUTPUTS, CAPTURES (output streams, then plain outputs), WORDS[], set_clock(), set_reset(), drive(),
// configure(), is_valid() and read().

#include <cstdint>
#include <new>
#include <vector>

#include "ports.h"

namespace {

struct Capture {
    std::vector<uint32_t> payload;
    std::vector<int64_t> clock;
};

struct Engine {
    VerilatedContext context;
    Dut dut{&context, ""};
    Capture captures[CAPTURES];
};

// The same numbers as sim.engine.plan.junk.
inline uint64_t junk(int64_t clock) {
    const uint64_t value = (static_cast<uint64_t>(clock) + 1) * 0x9E3779B97F4A7C15u;
    return value ^ (value >> 29);
}

inline void rising_edge(Dut& dut) {
    set_clock(dut, 1);
    dut.eval();
}

}  // namespace

extern "C" {

// The layout of sim.engine.stream._Schedule.
struct Schedule {
    int64_t clocks;
    const int64_t* beat_count;
    const int64_t* const* beat_clock;
    const uint64_t* const* beat_payload;
    int64_t change_count;
    const int64_t* change_clock;
    const int32_t* change_port;
    const uint64_t* change_value;
    int64_t reset_count;
    const int64_t* reset_clock;
};

#define EXPORT __attribute__((visibility("default")))

EXPORT Engine* engine_new() { return new (std::nothrow) Engine; }

EXPORT void engine_delete(Engine* engine) { delete engine; }

EXPORT void engine_reset(Engine* engine) {
    Dut& dut = engine->dut;
    for (int stream = 0; stream < INPUTS; stream++) drive(dut, stream, false, junk(-1));
    set_clock(dut, 0);
    set_reset(dut, 1);
    dut.eval();
    rising_edge(dut);
    set_reset(dut, 0);
}

EXPORT void engine_run(Engine* engine, const Schedule* schedule) {
    Dut& dut = engine->dut;
    for (Capture& capture : engine->captures) capture = Capture();
    std::vector<int64_t> beat(INPUTS, 0);
    int64_t change = 0, reset = 0;
    for (int64_t clock = 0; clock < schedule->clocks; clock++) {
        for (; change < schedule->change_count && schedule->change_clock[change] == clock; change++)
            configure(dut, schedule->change_port[change], schedule->change_value[change]);
        for (int stream = 0; stream < INPUTS; stream++) {
            int64_t& next = beat[stream];
            const bool valid = next < schedule->beat_count[stream] && schedule->beat_clock[stream][next] == clock;
            drive(dut, stream, valid, valid ? schedule->beat_payload[stream][next] : junk(clock));
            next += valid;
        }
        const bool in_reset = reset < schedule->reset_count && schedule->reset_clock[reset] == clock;
        reset += in_reset;
        set_reset(dut, in_reset);
        set_clock(dut, 0);
        dut.eval();
        for (int output = 0; output < CAPTURES && !in_reset; output++) {
            if (!is_valid(dut, output)) continue;
            Capture& capture = engine->captures[output];
            capture.payload.resize(capture.payload.size() + WORDS[output]);
            read(dut, output, &*(capture.payload.end() - WORDS[output]));
            capture.clock.push_back(clock);
        }
        rising_edge(dut);
    }
    set_reset(dut, 0);
}

EXPORT int64_t engine_count(const Engine* engine, int output) {
    return static_cast<int64_t>(engine->captures[output].clock.size());
}

EXPORT const uint32_t* engine_payload(const Engine* engine, int output) {
    return engine->captures[output].payload.data();
}

EXPORT const int64_t* engine_clock(const Engine* engine, int output) { return engine->captures[output].clock.data(); }

}  // extern "C"
