"""The firmware for Nios II, as far as another compiler can judge: its C, with stand-ins for intrinsics and HAL."""

import re

import pytest

from firmware.toolchain import ToolchainError
from firmware.toolchain.compile import FIRMWARE, TARGET, WARNINGS, run_zig
from firmware.toolchain.images import register_header

NIOS2 = FIRMWARE / "platform" / "nios2"

#: What nios2-elf-gcc knows by itself. A register or an instruction number that is not a constant fails to compile.
INTRINSICS = """
#define __builtin_custom_fnff(n, a, b) ((void)sizeof(char[(n) >= 252 && (n) <= 255 ? 1 : -1]), (a) + (b))
#define __builtin_rdctl(n) ((void)sizeof(char[(n) >= 0 && (n) < 32 ? 1 : -1]), 0)
#define __builtin_wrctl(n, value) ((void)sizeof(char[(n) >= 0 && (n) < 32 ? 1 : -1]), (void)(int)(value))
"""

#: Declarations of Altera's HAL (Nios II Software Developer Handbook, "HAL API Reference").
HAL = {
    "sys/alt_irq.h": """
        #include <stdint.h>
        typedef uint32_t alt_u32;
        typedef void (*alt_isr_func)(void *isr_context);
        int alt_ic_isr_register(alt_u32 controller, alt_u32 irq, alt_isr_func isr, void *context, void *flags);
        """,
    "sys/alt_exceptions.h": """
        #include <sys/alt_irq.h>
        typedef enum { NIOS2_EXCEPTION_RETURN_REISSUE_INST = 0, NIOS2_EXCEPTION_RETURN_SKIP_INST = 1 }
            alt_exception_result;
        typedef enum { NIOS2_EXCEPTION_UNKNOWN = -1, NIOS2_EXCEPTION_ILLEGAL_INST = 5 } alt_exception_cause;
        void alt_instruction_exception_register(
            alt_exception_result (*handler)(alt_exception_cause cause, alt_u32 exception_pc, alt_u32 bad_addr));
        """,
    "system.h": """
        #define NIOS2_RESET_ADDR 0x0
        """,
    "assert.h": "#define static_assert _Static_assert\n",
}


@pytest.fixture(scope="module")
def check(tmp_path_factory):
    """Compile a file without a warning, as the Makefile would include."""
    folder = tmp_path_factory.mktemp("nios2")
    (folder / "sys").mkdir()
    for name, text in HAL.items():
        (folder / name).write_text(text)
    (folder / "intrinsics.h").write_text(INTRINSICS)
    places = [NIOS2, FIRMWARE / "pose", FIRMWARE / "sensor", register_header(), folder]

    def compile_it(source):
        options = ("-std=c11", "-ffreestanding", "-c", *WARNINGS, "-include", "intrinsics.h")
        run_zig("cc", *TARGET, *options, *(f"-I{place}" for place in places), source, "-o", "unit.o", folder=folder)

    return compile_it


@pytest.mark.parametrize("part", ["pose", "sensor", "platform/nios2"])
def test_it_compiles(check, part):
    sources = sorted((FIRMWARE / part).glob("*.c"))
    assert sources
    for source in sources:
        check(source)


def test_header_alone(check, tmp_path):
    (tmp_path / "header.c").write_text('#include "platform.h"\nfloat f(float a) { return platform_divide(a, a); }\n')
    check(tmp_path / "header.c")


def test_the_check_can_fail(check, tmp_path):
    (tmp_path / "wrong.c").write_text(
        '#include "platform.h"\nfloat f(float a) { return __builtin_custom_fnff(9, a, a); }'
    )
    with pytest.raises(ToolchainError) as caught:
        check(tmp_path / "wrong.c")
    assert "wrong.c:2:27: error: " in str(caught.value)


def test_both_platforms_offer_the_same(check):
    """Every function that the soft core's header has is in this one too, with the same type."""
    pattern = r"^(?:_Noreturn )?(?:static inline )?((?:void|uint32_t|int) \w+\([\w, ]*\))"
    ours, theirs = (
        set(re.findall(pattern, (FIRMWARE / "platform" / name / "platform.h").read_text(), re.M))
        for name in ("nios2", "riscv")
    )
    assert len(theirs) >= 9
    assert theirs - ours == {"int platform_stack_intact(void)"}


def test_makefile_names_the_papers_numbers():
    flags = dict(re.findall(r"-mcustom-(\w+)=(\d+)", (NIOS2 / "Makefile").read_text()))
    header = dict(re.findall(r"NIOS2_(\w+) = (\d+)", (NIOS2 / "platform.h").read_text()))
    assert header == {"FMULS": "252", "FADDS": "253", "FSUBS": "254", "FDIVS": "255"}
    assert {name.upper(): number for name, number in flags.items()}.items() >= header.items()
    assert len(set(flags.values())) == len(flags) == 17
