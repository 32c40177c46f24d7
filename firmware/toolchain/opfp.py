"""From floating-point instructions to calls of the floating-point unit.

The compiler emits Zfinx: RISC-V's single-precision instructions on integer registers, R-type, major opcode OP-FP
(0x53). The core has no such opcode; it has custom-0 (0x0B), whose instructions it hands over to its CFU port as
``function_id`` = {funct7, funct3} with rs1 and rs2. So a changed opcode makes each instruction a call of the unit, and
nothing else of it changes.

The port does not show the rs2 *field*, and its unit has one result format and one rounding mode. What would
therefore compute something else than what the compiler meant is refused:

=============================  ======================================================================
fcvt.wu.s, fcvt.s.wu           only the rs2 field tells them from the signed conversions
rounding other than RNE, DYN   the unit rounds to nearest even; dynamic is that, as there is no ``frm``
fmadd, fmsub, fnmsub, fnmadd   three operands
flw, fsw, fmv.x.w, fmv.w.x     there are no F registers
other formats, other functions the unit does not have them
CSRs fflags, frm, fcsr         the core does not have them
custom-0                       would call the unit with somebody else's encoding
=============================  ======================================================================

fcvt.w.s may have any rounding mode, since funct3 is shown. Everything else has to be RV32IM, 32 bits long, and the
executable sections have to hold instructions only.

Source: The RISC-V Instruction Set Manual, volume I, chapters "F" and "Zfinx".
"""

import bisect
import io
import struct

from elftools.common.exceptions import ELFError
from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

from firmware.toolchain.errors import ToolchainError

__all__ = ["CUSTOM_0", "OP_FP", "RefusedError", "redirect", "redirect_word"]

OP_FP, CUSTOM_0, SYSTEM = 0x53, 0x0B, 0x73

#: Major opcodes of RV32IM.
BASE = frozenset({0x03, 0x0F, 0x13, 0x17, 0x23, 0x33, 0x37, 0x63, 0x67, 0x6F, SYSTEM})

#: Major opcodes that get an explanation of their own.
FOREIGN = {
    0x07: ("flw or fld", "there are no F registers"),
    0x27: ("fsw or fsd", "there are no F registers"),
    0x43: ("fmadd", "the port has two operands"),
    0x47: ("fmsub", "the port has two operands"),
    0x4B: ("fnmsub", "the port has two operands"),
    0x4F: ("fnmadd", "the port has two operands"),
    CUSTOM_0: ("custom-0", "it would be taken for a floating-point operation"),
}

NEAREST, DYNAMIC = 0, 7
RNE = frozenset({NEAREST, DYNAMIC})
ROUNDED = frozenset({0, 1, 2, 3, 4, DYNAMIC})

#: What is accepted of OP-FP, single precision: funct7 to mnemonic, funct3, and whether rs2 is an operand (if not,
#: its field must be 0).
ACCEPTED = {
    0x00: ("fadd.s", RNE, True),
    0x04: ("fsub.s", RNE, True),
    0x08: ("fmul.s", RNE, True),
    0x0C: ("fdiv.s", RNE, True),
    0x2C: ("fsqrt.s", RNE, False),
    0x10: ("fsgnj.s", frozenset({0, 1, 2}), True),
    0x14: ("fmin.s or fmax.s", frozenset({0, 1}), True),
    0x50: ("fle.s, flt.s or feq.s", frozenset({0, 1, 2}), True),
    0x60: ("fcvt.w.s", ROUNDED, False),
    0x68: ("fcvt.s.w", RNE, False),
    0x70: ("fclass.s", frozenset({1}), False),
}

UNSIGNED = {0x60: "fcvt.wu.s", 0x68: "fcvt.s.wu"}


class RefusedError(ValueError):
    """An instruction cannot be expressed on the port; the message names it and says why."""


def _redirect_float(word):
    funct7, rs2, funct3 = word >> 25, word >> 20 & 31, word >> 12 & 7
    if funct7 & 3:
        raise RefusedError("an operation of another format: the unit has single precision only")
    if funct7 in UNSIGNED and rs2 == 1:
        raise RefusedError(f"{UNSIGNED[funct7]}: only a field that the port does not show makes it unsigned")
    if (funct7, funct3, rs2) in {(0x70, 0, 0), (0x78, 0, 0)}:
        raise RefusedError(f"{'fmv.x.w' if funct7 == 0x70 else 'fmv.w.x'}: there are no F registers")
    if funct7 not in ACCEPTED:
        raise RefusedError("an OP-FP instruction that the unit does not have")
    mnemonic, functions, binary = ACCEPTED[funct7]
    if not binary and rs2:
        raise RefusedError(f"a variant of {mnemonic} that the unit does not have")
    if funct3 not in functions:
        field = "rounding mode" if DYNAMIC in functions else "funct3"
        raise RefusedError(f"{mnemonic} with {field} {funct3}: the unit does not have it")
    return word & ~0x7F | CUSTOM_0


def redirect_word(word):
    """One instruction as the core must see it.

    Parameters
    ----------
    word : int
        The 32 bits of the instruction.

    Returns
    -------
    int
        ``word`` itself, or with the opcode changed from OP-FP to custom-0.

    Raises
    ------
    RefusedError
        If the core would do something else than what the instruction says.
    """
    opcode = word & 0x7F
    if word & 3 != 3:
        raise RefusedError("a compressed instruction, or none at all: the core has 32-bit instructions only")
    if opcode == OP_FP:
        return _redirect_float(word)
    if opcode in FOREIGN:
        raise RefusedError("{}: {}".format(*FOREIGN[opcode]))
    if opcode not in BASE:
        raise RefusedError("no instruction of RV32IM")
    if opcode == SYSTEM and word >> 12 & 7 and word >> 20 in (1, 2, 3):
        raise RefusedError("an access to fflags, frm or fcsr: the core has none of them")
    return word


class _Labels:
    """Symbols of an ELF file, to say where an address is and where data begin."""

    def __init__(self, elf):
        tables = [section for section in elf.iter_sections() if isinstance(section, SymbolTableSection)]
        if not tables:
            raise ToolchainError("the program has no symbol table, so that data cannot be told from instructions")
        symbols = [symbol for table in tables for symbol in table.iter_symbols()]
        self.symbols = symbols
        named = [s for s in symbols if s["st_info"]["type"] in ("STT_FUNC", "STT_NOTYPE") and s.name]
        named = [s for s in named if s["st_shndx"] != "SHN_ABS" and not s.name.startswith(("$", ".L"))]
        self.named = sorted((s["st_value"], s.name) for s in named)

    def place(self, address):
        """``0x00000124 (solve+0x14)``, with the nearest symbol before ``address``."""
        at = bisect.bisect_right(self.named, (address, "\U0010ffff")) - 1
        if at < 0:
            return f"0x{address:08x}"
        start, name = self.named[at]
        return f"0x{address:08x} ({name}+0x{address - start:x})"

    def refuse_data(self, index, start, end):
        """Raise if section ``index``, at addresses ``start`` to ``end``, holds anything but instructions."""
        inside = [s for s in self.symbols if s["st_shndx"] == index]
        for symbol in inside:
            if symbol["st_info"]["type"] == "STT_OBJECT":
                raise ToolchainError(f"0x{symbol['st_value']:08x} ({symbol.name}): data in an executable section")
        marks = [(s["st_value"], s.name) for s in inside if s.name[:2] in ("$d", "$x")]
        for address, name in marks:
            if name.startswith("$d") and address < end:
                raise ToolchainError(f"{self.place(address)}: data in an executable section")
        if start < end and not marks:
            raise ToolchainError(f"0x{start:08x}: a section without mapping symbols, which may hold data")


def redirect(program):
    """A linked program with all its floating-point instructions redirected to the unit.

    Parameters
    ----------
    program : bytes
        An ELF file for RV32, with its symbols.

    Returns
    -------
    program : bytes
        The same file but for opcodes in its executable sections.
    count : int
        How many instructions have been changed.

    Raises
    ------
    ToolchainError
        If an instruction is refused; the message names address, symbol and instruction.
    """
    changed, count = bytearray(program), 0
    try:
        elf = ELFFile(io.BytesIO(program))
        labels = _Labels(elf)
        sections = list(enumerate(elf.iter_sections()))
    except ELFError as error:
        raise ToolchainError(f"not an ELF file: {error}") from None
    for index, section in sections:
        if not section["sh_flags"] & SH_FLAGS.SHF_EXECINSTR or section["sh_type"] == "SHT_NOBITS":
            continue
        start, size, offset = section["sh_addr"], section["sh_size"], section["sh_offset"]
        if start % 4 or size % 4:
            raise ToolchainError(f"{section.name}: not a whole number of 32-bit instructions")
        labels.refuse_data(index, start, start + size)
        for at in range(0, size, 4):
            (word,) = struct.unpack_from("<I", program, offset + at)
            try:
                new = redirect_word(word)
            except RefusedError as error:
                raise ToolchainError(f"{labels.place(start + at)}: {word:08x} is {error}") from None
            struct.pack_into("<I", changed, offset + at, new)
            count += new != word
    return bytes(changed), count
