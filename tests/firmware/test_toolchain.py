"""Images for the soft core: what they contain, that they are the same everywhere, and what is refused."""

import concurrent.futures
import ctypes
import multiprocessing
import random
import struct
import subprocess

import numpy as np
import pytest

from firmware.toolchain import Image, ToolchainError, build_image, compile
from firmware.toolchain.compile import PLATFORM, zig_folder
from hdl.config import RAM_BYTES
from tests.firmware.toolchain_case import image_of

FLOATS = "volatile float x, y;\nint main(void) { x = x * y + y / x; return 0; }\n"
SETTINGS = """
struct settings { int32_t a; float b; };
__attribute__((section(".settings"), used)) const struct settings settings = {7, 2.5f};
static const uint8_t table[6] = {1, 2, 3, 4, 5, 6};
volatile uint32_t sum;
__attribute__((section(".noinit"))) uint32_t kept[4];
int main(void) { for (uint32_t i = 0; i < 6; i++) sum += table[i * sum % 6]; return (int)kept[1]; }
"""
EMPTY = "int main(void) { return 0; }\n"


def complaint(call, *arguments, **options):
    with pytest.raises(ToolchainError) as caught:
        call(*arguments, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def opcodes(image):
    return image.words[: image.sizes.text // 4] & 0x7F


def body(image, symbol):
    start, size = image.symbols[symbol]
    return [int(word) for word in image.words[start // 4 : (start + size) // 4]]


def test_hardware_floats_are_calls_of_the_unit(tmp_path):
    image = image_of(tmp_path, FLOATS)
    assert {word >> 25 for word in body(image, "main") if word & 0x7F == 0x0B} == {0x08, 0x0C, 0x00}
    assert not any("sf" in name for name in image.symbols)


def test_software_floats_are_functions(tmp_path):
    image = image_of(tmp_path, FLOATS, floats="software")
    assert not np.isin(opcodes(image), (0x0B, 0x53)).any()
    assert all(any(part in name for name in image.symbols) for part in ("mulsf3", "divsf3", "addsf3"))


def test_unit_is_on_before_anything_can_call_it(tmp_path):
    """csrw 0xBC0 of bit 31 alone stands in _start, which calls nothing before."""
    start = body(image_of(tmp_path, FLOATS), "_start")
    enable, calls = start.index(0xBC029073), [i for i, word in enumerate(start) if word & 0x7F in (0x67, 0x6F)]
    assert start[enable - 1] == 0x800002B7
    assert enable + 8 < min(calls)


def test_sections_lie_as_the_linker_script_says(tmp_path):
    image = image_of(tmp_path, SETTINGS)
    symbols, sizes = image.symbols, image.sizes
    assert symbols["_start"].address == 0 and symbols["__stack_top"].address == RAM_BYTES == sizes.total
    assert symbols["settings"].size == 8 and symbols["kept"].size == 16
    assert symbols["__bss_start"].address <= symbols["sum"].address < symbols["__bss_end"].address
    assert symbols["__bss_end"].address <= symbols["kept"].address < symbols["__stack_low"].address
    assert sizes.rodata >= 6 + 8 and sizes.bss == 4 + 16
    assert sizes.used == symbols["__stack_low"].address == RAM_BYTES - sizes.stack
    assert sizes.text + sizes.rodata <= 4 * len(image.words) < sizes.text + sizes.rodata + 8
    a, b = struct.unpack_from("<if", image.words.tobytes(), symbols["settings"].address)
    assert (a, b) == (7, 2.5)


def test_same_bytes_wherever_it_is_built(tmp_path, monkeypatch):
    """Another folder of sources, of products and of the compiler's cache, and another working directory."""
    code = "const char *volatile file;\nint main(void) { file = __FILE__; return 0; }\n"
    here, there = tmp_path / "here", tmp_path / "over" / "there"
    here.mkdir()
    there.mkdir(parents=True)
    image = image_of(here, code)
    monkeypatch.chdir(there)
    monkeypatch.setattr(compile, "OUT", there / "out")
    assert image_of(there, code).elf == image.elf
    assert b"case.c\0" in image.elf and str(tmp_path).encode() not in image.elf


def test_built_once_for_the_same_sources(tmp_path, monkeypatch):
    (tmp_path / "value.h").write_text(f"#define VALUE {random.randrange(1 << 30)}\n")
    code = '#include "value.h"\nint main(void) { return VALUE; }\n'
    image = image_of(tmp_path, code)
    calls, run = [], compile.run_zig
    monkeypatch.setattr(compile, "run_zig", lambda *a, **k: calls.append(a) or run(*a, **k))
    assert image_of(tmp_path, code) == image and not calls
    (tmp_path / "value.h").write_text(f"#define VALUE {random.randrange(1 << 30)}\n")
    assert image_of(tmp_path, code) != image and len(calls) == 1
    assert image_of(tmp_path, code, defines=("NDEBUG",)) is not None and len(calls) == 2
    assert image_of(tmp_path, code, optimise="-Os") is not None and len(calls) == 3


def test_macros_and_include_folders(tmp_path):
    (tmp_path / "inc").mkdir()
    (tmp_path / "inc" / "there.h").write_text("#define THERE 0x123\n")
    code = '#include "there.h"\nint main(void) { return THERE + HERE; }\n'
    image = image_of(tmp_path, code, includes=[tmp_path / "inc"], defines=["HERE=0x400"])
    assert 0x52300513 in body(image, "main")  # li a0, 0x523


@pytest.mark.parametrize("floats", ["hardware", "software"])
def test_library_math(tmp_path, floats):
    functions = {"sinf": "x", "cosf": "x", "acosf": "x", "atanf": "x", "atan2f": "x, y", "sqrtf": "x"}
    declared = "".join(f"float {f}({a.replace('x', 'float x').replace('y', 'float y')});" for f, a in functions.items())
    called = " ".join(f"x = {function}({arguments});" for function, arguments in functions.items())
    code = f"{declared}\nvolatile float x, y;\nint main(void) {{ {called} return 0; }}\n"
    image = image_of(tmp_path, code, floats=floats, library_math=True)
    assert set(functions) <= set(image.symbols)
    assert (opcodes(image) == 0x0B).any() == (floats == "hardware")
    assert "undefined symbol: " in complaint(image_of, tmp_path, code, floats=floats)


def test_settings_are_patched(tmp_path):
    image = image_of(tmp_path, SETTINGS)
    patched = image.patched("settings", struct.pack("<if", -3, 9.0))
    changed = np.flatnonzero(image.words != patched.words)
    assert 4 * changed[0] == image.symbols["settings"].address and len(changed) == 2
    assert patched.words[changed].tobytes() == struct.pack("<if", -3, 9.0)
    assert patched.symbols == image.symbols and image.words[changed].tobytes() == struct.pack("<if", 7, 2.5)


@pytest.mark.parametrize(
    "symbol, size, message",
    [
        ("settings", 7, "case: settings has 8 bytes, not 7"),
        ("setting", 8, "case: no symbol setting"),
        ("sum", 4, "case: sum is no constant object"),
        ("main", 4, "case: main is no constant object"),
        ("__stack_top", 0, "case: __stack_top is no constant object"),
    ],
)
def test_wrong_patch(tmp_path, symbol, size, message):
    assert complaint(image_of(tmp_path, SETTINGS).patched, symbol, bytes(size)) == message


NO_DATA = "error: initialised variables would not survive a warm restart: make them const, or set them in code"
NO_ROOM = "error: the image leaves less than 2 KB of the RAM for the stack"
ODD = '__attribute__((section(".odd")))'


@pytest.mark.parametrize(
    "code, message",
    [
        ("int n = 3;\nint main(void) { return n++; }", f"ld.lld: {NO_DATA}"),
        ("volatile unsigned char a[31000];\nint main(void) { return a[a[0]]; }", f"ld.lld: {NO_ROOM}"),
        ("volatile unsigned char a[99000];\nint main(void) { return a[a[0]]; }", f"ld.lld: {NO_ROOM}"),
        ("void f(void);\nint main(void) { f(); return 0; }", "ld.lld: error: undefined symbol: f"),
        ("", "ld.lld: error: undefined symbol: main"),
        ("int main(void) { int unused; return 0; }", "FILE:6:22: error: unused variable 'unused'"),
        ("int main(void) { return nothing; }", "FILE:6:25: error: use of undeclared identifier 'nothing'"),
        ("#include <stdio.h>\n" + EMPTY, "FILE:6:10: fatal error: 'stdio.h' file not found"),
        (
            f"{ODD} const volatile int odd = 1;\nint main(void) {{ return odd; }}",
            "section .odd has no place in the linker",
        ),
        (f"{ODD} int odd = 1;\nint main(void) {{ return odd++; }}", "section .odd has no place in the linker script"),
    ],
)
def test_what_is_refused(tmp_path, code, message):
    message = message.replace("FILE", str(tmp_path / "case.c"))
    assert complaint(image_of, tmp_path, code).startswith(f"case: {message}")


def test_handlers_are_wanted(tmp_path):
    (tmp_path / "bare.c").write_text(EMPTY)
    assert complaint(build_image, [tmp_path / "bare.c"], name="bare").startswith(
        "bare: ld.lld: error: undefined symbol: "
    )


def test_missing_source(tmp_path):
    assert complaint(build_image, [tmp_path / "gone.c"], name="x") == f"x: {tmp_path}/gone.c not found"


def test_wrong_options():
    with pytest.raises(ValueError) as caught:
        build_image([], name="x", floats="none")
    assert str(caught.value) == "floats must be hardware or software, not 'none'"
    with pytest.raises(ValueError) as caught:
        build_image([], name="x", optimise="-O9")
    assert str(caught.value) == "optimise must be -O2 or -Os, not '-O9'"


@pytest.mark.parametrize("content", [b"", b"\x7fELF", b"nothing"])
def test_broken_image(content):
    assert complaint(Image, "broken", content).startswith("broken: not an image: ")


def test_truncated_and_foreign_images(tmp_path):
    elf = image_of(tmp_path, EMPTY).elf
    for length in range(0, len(elf), 97):
        assert complaint(Image, "cut", elf[:length]).startswith("cut: not ")
    assert complaint(Image, "host", (zig_folder() / "zig").read_bytes()).startswith("host: ")


def test_saved_files_agree(tmp_path):
    image = image_of(tmp_path, SETTINGS)
    elf, binary, text, names = image.save(tmp_path / "products")
    assert [path.name for path in (elf, binary, text, names)] == [f"case.{s}" for s in ("elf", "bin", "hex", "map")]
    assert Image("case", elf.read_bytes()) == image
    assert binary.read_bytes() == image.words.tobytes()
    assert [int(line, 16) for line in text.read_text().splitlines()] == image.words.tolist()
    assert f"{image.symbols['settings'].address:08x}      8 settings" in names.read_text().splitlines()


def test_memory_functions_do_not_call_themselves(tmp_path):
    """A compiler that knows these loops would call the functions they are in. Only their returns leave them."""
    code = "char a[99], b[99];\nvolatile unsigned n;\nvoid *memmove(void *, const void *, __SIZE_TYPE__);\n"
    code += "int main(void) { __builtin_memcpy(a, b, n); __builtin_memset(b, 1, n); memmove(a, a + 1, n); return 0; }"
    image = image_of(tmp_path, code)
    for name in ("memcpy", "memset", "memmove"):
        jumps = [word for word in body(image, name) if word & 0x7F == 0x67 or word & 0xFFF == 0x0EF]
        assert jumps and set(jumps) == {0x00008067}


def exercise(path):
    """Let the memory functions of a library of this machine do 4,000 things; the first that went wrong, or None."""
    library, rng = ctypes.CDLL(path), random.Random(3)
    for _ in range(4000):
        content = bytearray(rng.randbytes(96))
        buffer = (ctypes.c_char * 96).from_buffer(bytearray(content))
        base = ctypes.addressof(buffer)
        count = rng.choice((0, 1, 2, 3, 4, 5, 8, 12, rng.randrange(40)))
        to, other, value = rng.randrange(96 - count), rng.randrange(96 - count), rng.randrange(-300, 600)
        kind = rng.choice(("memmove", "memset") + ("memcpy",) * (abs(to - other) >= count))
        function = getattr(library, f"our_{kind}")
        function.restype = ctypes.c_void_p
        second = value if kind == "memset" else ctypes.c_void_p(base + other)
        result = function(ctypes.c_void_p(base + to), second, ctypes.c_size_t(count))
        content[to : to + count] = bytes([value & 255]) * count if kind == "memset" else content[other : other + count]
        if result != base + to or buffer.raw != bytes(content):
            return kind, to, other, count
    return None


def test_memory_functions(tmp_path):
    """Every alignment, short and long, overlapping either way, against slices of bytes.

    In a process of its own, which a misaligned word kills, as it would trap on the core.
    """
    renamed = [f"-D{name}=our_{name}" for name in ("memcpy", "memmove", "memset")]
    strict = ["-fsanitize=alignment", "-fsanitize-undefined-trap-on-error"]
    command = ["g++", "-x", "c", "-std=c11", "-O2", "-ffreestanding", "-shared", "-fPIC", *strict, *renamed]
    subprocess.run([*command, PLATFORM / "memory.c", "-o", tmp_path / "memory.so"], check=True)
    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        assert pool.submit(exercise, str(tmp_path / "memory.so")).result() is None


def test_header_of_the_platform(tmp_path):
    """All its functions can be called."""
    calls = "platform_enable_interrupts(); platform_unmask_interrupts(platform_mask_interrupts());"
    calls += " platform_wait_for_interrupt(); if (!platform_stack_intact()) platform_restart();"
    image = image_of(tmp_path, f"int main(void) {{ {calls} return (int)platform_clocks(); }}")
    assert 0x10500073 in body(image, "main")  # wfi
