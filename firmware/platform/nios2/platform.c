// Altera's HAL behind platform.h.
#include "platform.h"

#include <stddef.h>
#include <sys/alt_exceptions.h>
#include <sys/alt_irq.h>
#include <system.h>

#include "registers.h"

// Lines of the internal interrupt controller, number 0, as system.tcl connects them.
enum { CONTROLLER = 0, LINE_SENSOR = 0, LINE_TIMER = 2 };

static void on_sensor(void *context) {
    (void)context;
    interrupt_external();
}

static void on_timer(void *context) {
    (void)context;
    interrupt_timer();
}

static alt_exception_result on_exception(alt_exception_cause cause, alt_u32 address, alt_u32 value) {
    trap((uint32_t)cause, address, value);
    return NIOS2_EXCEPTION_RETURN_REISSUE_INST;
}

void platform_enable_interrupts(void) {
    alt_instruction_exception_register(on_exception);
    alt_ic_isr_register(CONTROLLER, LINE_SENSOR, on_sensor, NULL, NULL);
    alt_ic_isr_register(CONTROLLER, LINE_TIMER, on_timer, NULL, NULL);
    platform_unmask_interrupts(1);
}

uint32_t platform_clocks(void) { return SYSTEM->sensor.TIME; }

_Noreturn void platform_restart(void) {
    platform_mask_interrupts();
    ((void (*)(void))(uintptr_t)NIOS2_RESET_ADDR)();
    for (;;) continue;
}
