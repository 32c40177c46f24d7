// Calls of the floating-point unit on the processor's own port, while a timer
// interrupt that calls the unit too comes at any moment. The host writes the
// functions' code, operands and a job, and reads results when the job is done.
#include "platform.h"
#include "registers.h"

enum { OPERANDS = 480, FUNCTIONS = 24, WORDS = 24, SIZE = 4 * 1024 / 4 };

struct job {
    volatile uint32_t go,
        done;                    // serial number of the job to do, and of the one that is done
    uint32_t seed;               // of what happens between the calls
    uint32_t least, spread;      // clocks between interrupts
    uint32_t function;           // first of those that are called in turn
    uint32_t functions;          // how many; 0: switch the unit off and call that one
    uint32_t count;              // pairs of operands
    uint32_t interrupts, wrong;  // that came, and those in which the unit did not
                                 // say what it should
    uint32_t trap[3],
        traps;  // cause, address and value of the last one, and their number
};

struct job job;
uint32_t a[OPERANDS], b[OPERANDS], result[OPERANDS];
uint32_t code[FUNCTIONS][WORDS];         // of each function, uint32_t f(uint32_t, uint32_t)
static volatile uint32_t far[2 * SIZE];  // twice the data cache
static uint32_t chance;

static uint32_t call(uint32_t function, uint32_t at) {
    return ((uint32_t (*)(uint32_t, uint32_t))(uintptr_t)code[function])(a[at], b[at]);
}

static uint32_t random_bits(void) {
    chance ^= chance << 13;
    chance ^= chance >> 17;
    return chance ^= chance << 5;
}

static void forget_data_cache(void) { __asm__ volatile(".insn 4, 0x500F" ::: "memory"); }

static void forget_instruction_cache(void) { __asm__ volatile("fence.i" ::: "memory"); }

void interrupt_external(void) {}

void interrupt_timer(void) {
    static uint32_t next_period;
    SYSTEM->timer.STATUS = INTERVAL_TIMER__STATUS__EXPIRED_bm;
    next_period = next_period * 1664525u + 1013904223u;
    SYSTEM->timer.PERIOD = job.least + (uint32_t)((uint64_t)next_period * job.spread >> 32);
    volatile int32_t whole = (int32_t)(job.interrupts++ & 0xFFFF);  // Else the compiler takes it for unsigned.
    const float number = (float)whole;
    volatile float divisor = 3.0f;
    job.wrong += number * divisor / divisor != number;
}

void trap(uint32_t cause, uint32_t address, uint32_t value) {
    job.trap[0] = cause, job.trap[1] = address, job.trap[2] = value;
    job.traps++;
    __asm__ volatile("csrs 0xBC0, %0" ::"r"(0x80000000u) : "memory");  // Then the instruction is executed again.
}

// Between calls: nothing, loads that miss the cache, stores, a jump into
// another line of instructions, or empty caches.
static void disturb(uint32_t sum) {
    const uint32_t what = random_bits(), kind = what & 31;
    volatile uint32_t *const place = &far[what >> 8 & (2 * SIZE - 1)];
    if (kind < 4) {
        (void)*place;
    } else if (kind < 8) {
        *place = sum;
    } else if (kind < 12) {
        *place = far[what >> 19 & (2 * SIZE - 1)] + sum;
    } else if (kind < 16) {
        __asm__ volatile("j 1f\n\t.rept 9\n\tnop\n\t.endr\n1:" ::: "memory");
    } else if (kind == 16) {
        forget_instruction_cache();
    } else if (kind == 17) {
        forget_data_cache();
    }
}

static void work(void) {
    chance = job.seed | 1u;
    for (uint32_t at = 0; at < job.count; at++) {
        disturb(at);
        result[at] = call(job.function + at % job.functions, at);
    }
}

int main(void) {
    job.least = 100, job.spread = 150;
    SYSTEM->timer.PERIOD = 10000;
    SYSTEM->timer.CONTROL = INTERVAL_TIMER__CONTROL__RUN_bm | INTERVAL_TIMER__CONTROL__CONTINUOUS_bm;
    SYSTEM->timer.IRQ_ENABLE = INTERVAL_TIMER__IRQ_ENABLE__EXPIRED_bm;
    platform_enable_interrupts();
    SYSTEM->uart.DATA = '\n';
    for (;;) {
        uint32_t go;
        do forget_data_cache();  // The host writes behind its back.
        while ((go = job.go) == job.done);
        forget_instruction_cache();
        if (job.functions == 0) {
            platform_mask_interrupts();  // Their handler must not trap: it would lose
                                         // its way back.
            __asm__ volatile("csrc 0xBC0, %0" ::"r"(0x80000000u) : "memory");
            result[0] = call(job.function, 0);
            platform_unmask_interrupts(1);
        } else {
            work();
        }
        job.done = go;
    }
}
