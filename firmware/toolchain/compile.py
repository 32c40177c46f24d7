"""C and assembler to an :class:`~firmware.toolchain.image.Image`, by the clang and lld that PyPI's ``ziglang`` carries.

Nothing of the host gets in: neither headers, libraries nor environment. Images are kept under
``build/out/firmware/NAME-HASH/``; the hash covers sources, headers, flags and the compiler's version. ``linked.elf``
there is what the linker made, ``image.elf`` the same with its floating-point instructions redirected. The bytes are the
same wherever and whenever they are built.

An image consists of the sources given, the start-up code and memory functions of ``platform/riscv``, and what they need
of compiler-rt, which ``ziglang`` has in source and compiles for the very same target.
"""

import hashlib
import importlib.metadata
import os
import pathlib
import subprocess

from firmware.toolchain.errors import ToolchainError
from firmware.toolchain.image import Image
from firmware.toolchain.opfp import redirect
from sim.engine.build import OUT, locked

__all__ = ["FIRMWARE", "PLATFORM", "build_image", "run_zig", "zig_folder"]

FIRMWARE = pathlib.Path(__file__).parents[1]
PLATFORM = FIRMWARE / "platform" / "riscv"

#: Instructions the compiler may use. Relaxation makes most calls one instruction instead of two.
TARGET = ("-target", "riscv32-freestanding-none")
CPU = {"hardware": "generic_rv32+m+zicsr+relax+zfinx", "software": "generic_rv32+m+zicsr+relax"}

FLAGS = (
    "-mabi=ilp32",
    "-std=c11",
    "-ffreestanding",
    "-ffp-contract=off",  # A fused multiply-add has three operands, and rounds once.
    "-fno-math-errno",
    "-ffunction-sections",
    "-fdata-sections",
    "-fomit-frame-pointer",  # zig's default keeps it, for backtraces that nobody takes here.
    "-fno-unwind-tables",
    "-fno-asynchronous-unwind-tables",
    "-fno-stack-protector",
    "-fno-sanitize=all",
    "-fno-jump-tables",  # They would do no harm in .rodata; a compare and a branch are as fast here, and smaller.
    "-g",  # Else zig strips the symbols of small programs; the linker script drops what it adds.
)
WARNINGS = ("-Wall", "-Wextra", "-Werror")
LINK = ("-static", "-Wl,--gc-sections", "-Wl,--build-id=none")

#: Files that an image may depend on, besides its sources, in the folders that it includes from.
HEADERS = (".h", ".inc")


def zig_folder():
    """Folder of PyPI's ``ziglang``: the compiler ``zig`` and its ``lib``."""
    try:
        import ziglang
    except ImportError:
        raise ToolchainError("ziglang not found: install it with pip install ziglang") from None
    return pathlib.Path(ziglang.__file__).parent


def run_zig(*arguments, folder, log=None):
    """Run ``zig`` in ``folder``; raise a :class:`ToolchainError` with its first error line if it fails."""
    caches = OUT / "zig"
    result = subprocess.run(
        [str(zig_folder() / "zig"), *map(str, arguments)],
        cwd=folder,
        env={
            "PATH": os.defpath,
            "ZIG_GLOBAL_CACHE_DIR": str(caches / "global"),
            "ZIG_LOCAL_CACHE_DIR": str(caches / "local"),
        },
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        check=False,
    )
    if log:
        log.write("$ zig " + " ".join(map(str, arguments)) + "\n" + result.stdout)
    if result.returncode:
        lines = result.stdout.strip().splitlines() or [f"zig ended with status {result.returncode}"]
        line = next((line for line in lines if "error:" in line), lines[-1])
        raise ToolchainError(line.strip().replace(f"{FIRMWARE.parent}{os.sep}", ""))


def _contents(paths):
    """Names and bytes of files, without their folders, so that a copy elsewhere is the same."""
    return [(path.name, path.read_bytes()) for path in paths]


def _digest(sources, includes, options):
    digest = hashlib.sha256()
    below = [path for folder in includes for path in sorted(folder.rglob("*"))]
    beside = [path for folder in sorted({source.parent for source in sources}) for path in sorted(folder.iterdir())]
    headers = [path for path in [*below, *beside] if path.suffix in HEADERS]
    own = [path for path in sorted(pathlib.Path(__file__).parent.iterdir()) if path.suffix in (".py", ".zig")]
    own += sorted(PLATFORM.iterdir())
    for part in (importlib.metadata.version("ziglang"), options, *map(_contents, (sources, headers, own))):
        digest.update(repr(part).encode())
    return digest.hexdigest()[:20]


def _library_math(cpu, scratch, log):
    """Objects of the C library's acosf, atanf and atan2f; its sinf, cosf and sqrtf are in compiler-rt."""
    source = pathlib.Path(__file__).with_name("library_math.zig")
    target = (*TARGET, f"-mcpu={cpu}")
    options = ("-O", "ReleaseFast", "-fstrip", "-fno-unwind-tables", "-ffunction-sections", "-fdata-sections")
    run_zig("build-obj", *target, *options, "-femit-bin=library_math.o", source, folder=scratch, log=log)
    libc = zig_folder() / "lib" / "libc"
    system = [libc / "include" / name for name in ("riscv32-linux-musl", "generic-musl")]
    own = [libc / "musl" / name for name in ("src/include", "src/internal", "arch/generic")]
    folders = [f"-I{folder}" for folder in own] + [part for folder in system for part in ("-isystem", str(folder))]
    command = ("cc", *target, *FLAGS, "-O2", "-w", *folders, "-c", libc / "musl/src/math/atan2f.c", "-o", "atan2f.o")
    run_zig(*command, folder=scratch, log=log)
    return ["library_math.o", "atan2f.o"]


def build_image(sources, *, name, floats="hardware", optimise="-O2", defines=(), includes=(), library_math=False):
    """Build an image for the soft core, or take it from where it is kept.

    Parameters
    ----------
    sources : iterable of path
        C and assembler (``.S``) files. They define ``main`` and what ``platform/riscv/platform.h`` asks for.
    name : str
        What the image is called, a word.
    floats : str
        ``"hardware"``: floating-point operations call the unit on the core's CFU port. ``"software"``: they call
        compiler-rt's functions.
    optimise : str
        ``"-O2"`` or ``"-Os"``.
    defines : iterable of str
        Macros, ``"NAME"`` or ``"NAME=VALUE"``.
    includes : iterable of path
        Folders of headers, besides ``platform/riscv``.
    library_math : bool
        Whether sinf, cosf, acosf, atanf, atan2f and sqrtf are there to be called, as a C library has them: those of
        musl, which ``ziglang`` carries in C or rewritten in Zig. sinf and cosf compute in double precision, which is
        software on any core here; sqrtf is software too (``__builtin_sqrtf`` is the unit's).

    Returns
    -------
    Image

    Raises
    ------
    ToolchainError
        If the compiler, the linker or :mod:`~firmware.toolchain.opfp` has a complaint: one line, with the name.
    ValueError
        If an option is none of the above.
    """
    if floats not in CPU:
        raise ValueError(f"floats must be hardware or software, not {floats!r}")
    if optimise not in ("-O2", "-Os"):
        raise ValueError(f"optimise must be -O2 or -Os, not {optimise!r}")
    sources = [pathlib.Path(source).resolve() for source in sources]
    includes = [pathlib.Path(folder).resolve() for folder in includes]
    missing = next((path for path in [*sources, *includes] if not path.exists()), None)
    if missing:
        raise ToolchainError(f"{name}: {missing} not found")
    options = (name, floats, optimise, tuple(defines), library_math, TARGET, CPU, FLAGS, WARNINGS, LINK)
    folder = OUT / "firmware" / f"{name}-{_digest(sources, includes, options)}"
    try:
        with locked(folder) as scratch:
            if scratch is not None:
                with open(scratch / "build.log", "w") as log:
                    objects = _library_math(CPU[floats], scratch, log) if library_math else []
                    _compile(sources, includes, defines, CPU[floats], optimise, objects, scratch, log)
                program, _ = redirect((scratch / "linked.elf").read_bytes())
                (scratch / "image.elf").write_bytes(program)
        return Image(name, (folder / "image.elf").read_bytes())
    except ToolchainError as error:
        raise ToolchainError(f"{name}: {str(error).removeprefix(f'{name}: ')}") from None


def _compile(sources, includes, defines, cpu, optimise, objects, scratch, log):
    """Compile and link everything to ``linked.elf``."""
    folders = [f"-I{folder}" for folder in (PLATFORM, *includes)]
    # What __FILE__ says must not depend on where the sources are.
    roots = sorted({FIRMWARE.parent, *(path.parent for path in sources if FIRMWARE.parent not in path.parents)})
    maps = [f"-ffile-prefix-map={root}=." for root in roots]
    run_zig(
        "cc",
        *(*TARGET, f"-mcpu={cpu}", *FLAGS, optimise, *WARNINGS, *maps, *folders),
        *(f"-D{macro}" for macro in defines),
        *(PLATFORM / "start.S", PLATFORM / "memory.c", *sources, *objects),
        *(*LINK, "-T", PLATFORM / "link.ld", "-o", "linked.elf"),
        folder=scratch,
        log=log,
    )
