# Reset, restart and traps of the soft core. What the core does is told in platform.h.

    .equ    CFU_AND_MASK, 0xBC0
    .equ    CFU_ENABLE, 0x80000000
    .equ    MIE, 8
    .equ    TIMER, 7                    # The other interrupt is the external one, 11.
    .equ    STACK_PAINT, 0xC5C5C5C5     # platform.h has it too.

    .section .init, "ax", @progbits
    .globl  _start
    .type   _start, @function
_start:
    # A restart by software may come from anywhere: no interrupts before main asks for them.
    csrci   mstatus, MIE
    csrw    mie, zero
    # The unit before any call of it, and all interrupt lines masked. A call that is only fetched while the unit is
    # off would trap, so much other work follows.
    li      t0, CFU_ENABLE
    csrw    CFU_AND_MASK, t0
    la      sp, __stack_top
    la      t0, trap_entry
    csrw    mtvec, t0

    la      t0, __bss_start
    la      t1, __bss_end
    j       2f
1:  sw      zero, 0(t0)
    addi    t0, t0, 4
2:  bltu    t0, t1, 1b

    # Painted, so that one can see how far down it was ever used; the lowest word is the canary.
    la      t0, __stack_low
    li      t1, STACK_PAINT
3:  sw      t1, 0(t0)
    addi    t0, t0, 4
    bltu    t0, sp, 3b

    call    main

    # main has no reason to return. Without interrupts nobody serves the watchdog, which restarts the system.
    csrci   mstatus, MIE
4:  j       4b
    .size   _start, . - _start

    # Saves what C functions may change; there are no other registers, as floats are in these too.
    .section .text.trap_entry, "ax", @progbits
    .balign 4
    .globl  trap_entry
    .type   trap_entry, @function
trap_entry:
    addi    sp, sp, -64
    sw      ra, 0(sp)
    sw      t0, 4(sp)
    sw      t1, 8(sp)
    sw      t2, 12(sp)
    sw      t3, 16(sp)
    sw      t4, 20(sp)
    sw      t5, 24(sp)
    sw      t6, 28(sp)
    sw      a0, 32(sp)
    sw      a1, 36(sp)
    sw      a2, 40(sp)
    sw      a3, 44(sp)
    sw      a4, 48(sp)
    sw      a5, 52(sp)
    sw      a6, 56(sp)
    sw      a7, 60(sp)

    csrr    a0, mcause
    bltz    a0, 1f
    csrr    a1, mepc
    csrr    a2, mtval
    call    trap
    j       2f
1:  andi    a0, a0, 15
    li      a1, TIMER
    beq     a0, a1, 3f
    call    interrupt_external
    j       2f
3:  call    interrupt_timer

2:  lw      ra, 0(sp)
    lw      t0, 4(sp)
    lw      t1, 8(sp)
    lw      t2, 12(sp)
    lw      t3, 16(sp)
    lw      t4, 20(sp)
    lw      t5, 24(sp)
    lw      t6, 28(sp)
    lw      a0, 32(sp)
    lw      a1, 36(sp)
    lw      a2, 40(sp)
    lw      a3, 44(sp)
    lw      a4, 48(sp)
    lw      a5, 52(sp)
    lw      a6, 56(sp)
    lw      a7, 60(sp)
    addi    sp, sp, 64
    mret
    .size   trap_entry, . - trap_entry
