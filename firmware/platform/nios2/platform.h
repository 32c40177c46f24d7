// What the program needs of its processor, for Altera's Nios II/f with floating-point custom instructions.
//
// The same functions as for the soft core, on control registers: status (ctl0, bit 0 lets interrupts come), ienable
// (ctl3) and ipending (ctl4). Interrupts are internal ones; platform.c connects them through Altera's HAL.
// Not run: README.md says why.
#ifndef RASTERPOSE_PLATFORM_H
#define RASTERPOSE_PLATFORM_H

#include <stdint.h>

// Numbers of the custom instructions, as in the paper's figure 10.
enum { NIOS2_FMULS = 252, NIOS2_FADDS = 253, NIOS2_FSUBS = 254, NIOS2_FDIVS = 255 };

// The unit's operations one at a time. Expressions need none of them: the Makefile tells the compiler the numbers.
static inline float platform_multiply(float a, float b) { return __builtin_custom_fnff(NIOS2_FMULS, a, b); }
static inline float platform_add(float a, float b) { return __builtin_custom_fnff(NIOS2_FADDS, a, b); }
static inline float platform_subtract(float a, float b) { return __builtin_custom_fnff(NIOS2_FSUBS, a, b); }
static inline float platform_divide(float a, float b) { return __builtin_custom_fnff(NIOS2_FDIVS, a, b); }

// The program defines these, as for the soft core.
void interrupt_external(void);
void interrupt_timer(void);
void trap(uint32_t cause, uint32_t address, uint32_t value);

// Lets the sensor and the timer interrupt, and exceptions come to trap.
void platform_enable_interrupts(void);

// Keeps interrupts off; tells for platform_unmask_interrupts whether they were on.
static inline uint32_t platform_mask_interrupts(void) {
    const uint32_t status = (uint32_t)__builtin_rdctl(0);
    __builtin_wrctl(0, (int)(status & ~1u));
    return status & 1u;
}

static inline void platform_unmask_interrupts(uint32_t on) {
    __builtin_wrctl(0, (int)((uint32_t)__builtin_rdctl(0) | on));
}

// Until an interrupt is pending; the processor cannot halt. To be called with interrupts masked, else never returns.
static inline void platform_wait_for_interrupt(void) {
    while (!__builtin_rdctl(4)) continue;
}

// Clocks since reset, modulo 2^32: the sensor's own count, as the processor has none.
uint32_t platform_clocks(void);

// Starts the program again from the processor's reset address.
_Noreturn void platform_restart(void);

#endif
