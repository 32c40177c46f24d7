// What the program needs of its processor, for the soft core: VexRiscv "FullCfu", RV32IM, machine mode only.
//
// Its CSRs are mstatus (MIE, MPIE, MPP), mie and mip (MEI, MTI, MSI), mtvec (direct, whatever its low bits say),
// mscratch, mepc, mcause, mtval, misa, mvendorid, marchid, mimpid, mhartid, mcycle(h), minstret(h), cycle(h),
// instret(h), and two of its own:
//
//   0xBC0  mask of the 32 external interrupt lines. Its bit 31 also switches the floating-point unit on, so every write
//          has to keep it, and line 31 has to stay low.
//   0xFC0  the lines that are active and not masked, read only.
//
// Access to any other, and a write to a read-only one, is an illegal instruction. Exceptions:
//
//   mcause  what                                                mtval
//        0  jump or branch to no multiple of 4                  where to
//        2  illegal instruction, which ebreak is, and a call    the instruction
//           of the floating-point unit while that is off
//        4  load from a misaligned address                      the address
//        6  store to a misaligned address                       the address
//       11  ecall                                               the instruction
//
// mepc is the address of the instruction, which has had no effect. There are no access faults: the core ignores the
// error lines of its buses, and waits for ever for a bus that does not answer. Interrupts are 7, timer, and 11,
// external, which goes first; they leave mtval alone.
//
// wfi halts until an interrupt that mie enables is pending, whether mstatus.MIE lets it come or not. So who looks for
// an event with interrupts masked, and then waits with interrupts masked, misses none.
#ifndef RASTERPOSE_PLATFORM_H
#define RASTERPOSE_PLATFORM_H

#include <stdint.h>

// External interrupt lines, a bit each.
enum { PLATFORM_LINE_SENSOR = 1u << 0, PLATFORM_LINE_UART = 1u << 1 };

// The program defines these; they run with interrupts masked, on the one stack. An interrupt comes again at once if its
// function does not clear what raised it. If trap returns, the instruction at address is executed again.
void interrupt_external(void);
void interrupt_timer(void);
void trap(uint32_t cause, uint32_t address, uint32_t value);

// Lets the sensor and the timer interrupt.
static inline void platform_enable_interrupts(void) {
    const uint32_t fpu_on = 0x80000000u, timer = 1u << 7, external = 1u << 11, mie = 1u << 3;
    __asm__ volatile("csrw 0xBC0, %0" ::"r"(fpu_on | PLATFORM_LINE_SENSOR) : "memory");
    __asm__ volatile("csrw mie, %0" ::"r"(timer | external) : "memory");
    __asm__ volatile("csrs mstatus, %0" ::"r"(mie) : "memory");
}

// Keeps interrupts off; tells for platform_unmask_interrupts whether they were on.
static inline uint32_t platform_mask_interrupts(void) {
    uint32_t before;
    __asm__ volatile("csrrci %0, mstatus, 8" : "=r"(before)::"memory");
    return before >> 3 & 1u;
}

static inline void platform_unmask_interrupts(uint32_t on) {
    __asm__ volatile("csrs mstatus, %0" ::"r"(on << 3) : "memory");
}

// Halts until an interrupt is pending; with interrupts masked it goes on without taking it.
static inline void platform_wait_for_interrupt(void) { __asm__ volatile("wfi" ::: "memory"); }

// Clocks since reset, modulo 2^32.
static inline uint32_t platform_clocks(void) {
    uint32_t clocks;
    __asm__ volatile("csrr %0, mcycle" : "=r"(clocks)::"memory");
    return clocks;
}

// Starts the program again as after reset, but for variables in section .noinit and for what peripherals hold.
_Noreturn static inline void platform_restart(void) {
    __asm__ volatile("csrci mstatus, 8\n\tj _start" ::: "memory");
    __builtin_unreachable();
}

// 0 if the stack has been used up since the start.
static inline int platform_stack_intact(void) {
    extern const volatile uint32_t __stack_low[];
    return __stack_low[0] == 0xC5C5C5C5u;  // As start.S paints it.
}

#endif
