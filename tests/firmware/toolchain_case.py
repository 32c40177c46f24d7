"""Small programs for tests of the compiler path."""

from firmware.toolchain import build_image
from firmware.toolchain.compile import CPU, TARGET, run_zig

#: What platform.h asks of every program.
HANDLERS = """
#include "platform.h"
void interrupt_external(void) {}
void interrupt_timer(void) {}
void trap(uint32_t cause, uint32_t address, uint32_t value) { (void)cause, (void)address, (void)value; }
"""


def image_of(folder, code, name="case", **options):
    """The image of C code, with the handlers that every program has."""
    source = folder / f"{name}.c"
    source.write_text(HANDLERS + code)
    return build_image([source], name=name, **options)


def linked(folder, assembler, cpu=CPU["hardware"], arguments=()):
    """ELF file of assembler text, linked to address 0 without any pass."""
    (folder / "case.S").write_text(".globl _start\n_start:\n" + assembler)
    (folder / "case.ld").write_text("SECTIONS { . = 0; .text : { *(.text) } .other : { *(.other) } }")
    command = ("-mabi=ilp32", "-g0", "-nostdlib", "-static", "-Wl,--build-id=none", "-T", "case.ld", *arguments)
    run_zig("cc", *TARGET, f"-mcpu={cpu}", *command, "case.S", "-o", "case.elf", folder=folder)
    return (folder / "case.elf").read_bytes()
