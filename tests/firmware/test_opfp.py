"""Floating-point instructions redirected to the unit: each word there is, and linked programs."""

import io
import random
import re
import struct

import pytest
from elftools.elf.elffile import ELFFile

from firmware.toolchain import ToolchainError
from firmware.toolchain.opfp import RefusedError, redirect, redirect_word
from tests.firmware.toolchain_case import image_of, linked

#: The manual's table of RV32F, as far as the port can express it: funct7, rs2, funct3. A dot is any bit.
TABLE = """
    fadd.s     0000000 ..... 000|111
    fsub.s     0000100 ..... 000|111
    fmul.s     0001000 ..... 000|111
    fdiv.s     0001100 ..... 000|111
    fsqrt.s    0101100 00000 000|111
    fsgnj.s    0010000 ..... 000
    fsgnjn.s   0010000 ..... 001
    fsgnjx.s   0010000 ..... 010
    fmin.s     0010100 ..... 000
    fmax.s     0010100 ..... 001
    fcvt.w.s   1100000 00000 000|001|010|011|100|111
    feq.s      1010000 ..... 010
    flt.s      1010000 ..... 001
    fle.s      1010000 ..... 000
    fclass.s   1110000 00000 001
    fcvt.s.w   1101000 00000 000|111
"""


def r_type(funct7, rs2, rs1, funct3, rd, opcode=0x53):
    return funct7 << 25 | rs2 << 20 | rs1 << 15 | funct3 << 12 | rd << 7 | opcode


def text_of(program):
    return ELFFile(io.BytesIO(program)).get_section_by_name(".text").data()


def words_of(program):
    return [word for (word,) in struct.iter_unpack("<I", text_of(program))]


def refusal(program):
    with pytest.raises(ToolchainError) as caught:
        redirect(program)
    return str(caught.value)


def test_every_op_fp_encoding():
    """All 32,768 of funct7, rs2 and funct3: what the table has changes its opcode, the rest is refused."""
    rows = [line.split() for line in TABLE.strip().splitlines()]
    table = re.compile("|".join(f"{funct7} {rs2} (?:{funct3})" for _, funct7, rs2, funct3 in rows))
    rng, accepted = random.Random(1), 0
    for fields in range(1 << 15):
        funct7, rs2, funct3 = fields >> 8, fields >> 3 & 31, fields & 7
        word = r_type(funct7, rs2, rng.randrange(32), funct3, rng.randrange(32))
        if table.fullmatch(f"{funct7:07b} {rs2:05b} {funct3:03b}"):
            assert redirect_word(word) == word - 0x53 + 0x0B
            accepted += 1
        else:
            with pytest.raises(RefusedError):
                redirect_word(word)
    assert accepted == 4 * 32 * 2 + 2 + 3 * 32 + 2 * 32 + 6 + 3 * 32 + 1 + 2


def test_every_other_major_opcode():
    """RV32IM's pass unchanged, whatever their other bits; none else does."""
    # load, misc-mem, op-imm, auipc, store, op, lui, branch, jalr, jal
    base = {
        0b0000011,
        0b0001111,
        0b0010011,
        0b0010111,
        0b0100011,
        0b0110011,
        0b0110111,
        0b1100011,
        0b1100111,
        0b1101111,
    }
    rng = random.Random(2)
    for opcode in set(range(128)) - {0x53, 0x73}:
        for _ in range(50):
            word = rng.getrandbits(25) << 7 | opcode
            if opcode in base:
                assert redirect_word(word) == word
            else:
                with pytest.raises(RefusedError):
                    redirect_word(word)


@pytest.mark.parametrize(
    "word, message",
    [
        (r_type(0x60, 1, 10, 1, 10), "fcvt.wu.s: only a field that the port does not show makes it unsigned"),
        (r_type(0x68, 1, 10, 7, 10), "fcvt.s.wu: only a field that the port does not show makes it unsigned"),
        (r_type(0x60, 2, 10, 1, 10), "a variant of fcvt.w.s that the unit does not have"),
        (r_type(0x00, 3, 10, 1, 10), "fadd.s with rounding mode 1: the unit does not have it"),
        (r_type(0x2C, 0, 10, 4, 10), "fsqrt.s with rounding mode 4: the unit does not have it"),
        (r_type(0x68, 0, 10, 1, 10), "fcvt.s.w with rounding mode 1: the unit does not have it"),
        (r_type(0x60, 0, 10, 5, 10), "fcvt.w.s with rounding mode 5: the unit does not have it"),
        (r_type(0x14, 3, 10, 2, 10), "fmin.s or fmax.s with funct3 2: the unit does not have it"),
        (r_type(0x70, 0, 10, 0, 10), "fmv.x.w: there are no F registers"),
        (r_type(0x78, 0, 10, 0, 10), "fmv.w.x: there are no F registers"),
        (r_type(0x01, 3, 10, 7, 10), "an operation of another format: the unit has single precision only"),
        (r_type(0x02, 3, 10, 7, 10), "an operation of another format: the unit has single precision only"),
        (r_type(0x20, 1, 10, 7, 10), "an OP-FP instruction that the unit does not have"),
        (r_type(0x00, 3, 10, 7, 10, 0x43), "fmadd: the port has two operands"),
        (r_type(0x00, 3, 10, 7, 10, 0x47), "fmsub: the port has two operands"),
        (r_type(0x00, 3, 10, 7, 10, 0x4B), "fnmsub: the port has two operands"),
        (r_type(0x00, 3, 10, 7, 10, 0x4F), "fnmadd: the port has two operands"),
        (r_type(0x00, 3, 10, 2, 10, 0x07), "flw or fld: there are no F registers"),
        (r_type(0x00, 3, 10, 2, 10, 0x27), "fsw or fsd: there are no F registers"),
        (r_type(0x00, 3, 10, 7, 10, 0x0B), "custom-0: it would be taken for a floating-point operation"),
        (0x00202573, "an access to fflags, frm or fcsr: the core has none of them"),
        (0x0000006B, "no instruction of RV32IM"),
        (0x00010001, "a compressed instruction, or none at all: the core has 32-bit instructions only"),
        (0x00000000, "a compressed instruction, or none at all: the core has 32-bit instructions only"),
    ],
)
def test_refusal_says_why(word, message):
    with pytest.raises(RefusedError) as caught:
        redirect_word(word)
    assert str(caught.value) == message


@pytest.mark.parametrize("word", [0x00000073, 0x30200073, 0x10500073, 0x30046073, 0xBC029073, 0xFC002573])
def test_system_instructions_pass(word):
    """ecall, mret, wfi, csrsi mstatus, csrw 0xBC0, csrr 0xFC0."""
    assert redirect_word(word) == word


def test_assembler_and_table_agree(tmp_path):
    """Every mnemonic of the table, as the assembler encodes it."""
    unary = {"fsqrt.s", "fcvt.w.s", "fclass.s", "fcvt.s.w"}
    mnemonics = [line.split()[0] for line in TABLE.strip().splitlines()]
    lines = [f"{name} a0, a1\n" if name in unary else f"{name} a0, a1, a2\n" for name in mnemonics]
    program = linked(tmp_path, "".join(lines) + "fcvt.w.s a0, a1, rtz\nfneg.s a0, a1\nadd a0, a1, a2\n")
    before, (after, count) = words_of(program), redirect(program)
    assert [word & 0x7F for word in before] == [0x53] * (len(lines) + 2) + [0x33]
    assert words_of(after) == [word - 0x53 + 0x0B for word in before[:-1]] + before[-1:]
    assert count == len(lines) + 2
    text, start = text_of(program), program.index(text_of(program))
    assert after[:start] + after[start + len(text) :] == program[:start] + program[start + len(text) :]


@pytest.mark.parametrize(
    "assembler, cpu, message",
    [
        ("nop\nsolve: nop\nfcvt.wu.s a0, a1, rtz\n", "+zfinx", "0x00000008 (solve+0x4): c0159553 is fcvt.wu.s: only"),
        ("fadd.s a0, a1, a2, rup\n", "+zfinx", "0x00000000 (_start+0x0): 00c5b553 is fadd.s with rounding mode 3:"),
        ("fmadd.s a0, a1, a2, a3\n", "+zfinx", "0x00000000 (_start+0x0): 68c5f543 is fmadd: the port has two operands"),
        ("flw fa0, 0(a0)\n", "+f", "0x00000000 (_start+0x0): 00052507 is flw or fld: there are no F registers"),
        ("fmv.w.x fa0, a0\n", "+f", "0x00000000 (_start+0x0): f0050553 is fmv.w.x: there are no F registers"),
        ("fadd.d a0, a2, a4\n", "+zdinx", "0x00000000 (_start+0x0): 02e67553 is an operation of another format:"),
        ("frrm a0\n", "+zfinx", "0x00000000 (_start+0x0): 00202573 is an access to fflags, frm or fcsr:"),
        (".insn r 0x0B, 7, 0, a0, a0, a0\n", "", "0x00000000 (_start+0x0): 00a5750b is custom-0:"),
        ("amoadd.w a0, a0, (a1)\n", "+a", "0x00000000 (_start+0x0): 00a5a52f is no instruction of RV32IM"),
        ("c.nop\nc.nop\n", "+c", "0x00000000 (_start+0x0): 00010001 is a compressed instruction, or none at all:"),
        ("c.nop\n", "+c", ".text: not a whole number of 32-bit instructions"),
        ("nop\ntable: .word 0x00000013\n", "", "0x00000004 (table+0x0): data in an executable section"),
        (".type k, @object\nk: nop\n.size k, 4\n", "", "0x00000000 (k): data in an executable section"),
    ],
)
def test_linked_program_is_refused(tmp_path, assembler, cpu, message):
    found = refusal(linked(tmp_path, assembler, cpu="generic_rv32+m+zicsr" + cpu))
    assert found.startswith(message)
    assert "\n" not in found


def test_every_executable_section_is_looked_at(tmp_path):
    section = '.section .other, "ax", @progbits\nsecond: fadd.s a0, a1, a2\n'
    program = linked(tmp_path, "fadd.s a0, a1, a2\n" + section)
    after, count = redirect(program)
    assert count == 2
    assert [ELFFile(io.BytesIO(after)).get_section_by_name(n).data()[0] for n in (".text", ".other")] == [0x0B, 0x0B]


def test_constants_elsewhere_are_left_alone(tmp_path):
    """A word of .rodata that looks like an instruction."""
    program = linked(tmp_path, 'nop\n.section .rodata, "a", @progbits\n.word 0x00c58553\n')
    assert redirect(program) == (program, 0)


def test_mark_of_data_at_the_end_is_harmless(tmp_path):
    """As an empty constant pool leaves one."""
    program = linked(tmp_path, 'fadd.s a0, a1, a2\n"$d": \n')
    assert redirect(program)[1] == 1


def test_program_without_symbols(tmp_path):
    program = linked(tmp_path, "nop\n", arguments=("-s",))
    assert refusal(program) == "the program has no symbol table, so that data cannot be told from instructions"


@pytest.mark.parametrize("content", [b"", b"\x7fELF", b"no program at all"])
def test_no_elf_file(content):
    assert refusal(content).startswith("not an ELF file: ")


@pytest.mark.parametrize(
    "expression, message",
    [
        ("(float)(unsigned)n", "fcvt.s.wu"),
        ("n = (int)(unsigned)x, x", "fcvt.wu.s"),
        ("__builtin_fmaf(x, x, x)", "fmadd"),
    ],
)
def test_c_that_the_port_cannot_express(tmp_path, expression, message):
    """What a programmer writes, and where the message says it is."""
    code = f"volatile float x; volatile int n;\nint main(void) {{ x = ({expression}); return 0; }}"
    with pytest.raises(ToolchainError) as caught:
        image_of(tmp_path, code)
    assert re.fullmatch(rf"case: 0x0000\w+ \(main\+0x\w+\): \w{{8}} is {message}: [a-z ]+", str(caught.value))


def test_c_that_it_can(tmp_path):
    """One call of each function of the unit that C has an expression for, and no floats in software."""
    expressions = {
        "x + y": 0x00, "x - y": 0x04, "x * y": 0x08, "x / y": 0x0C, "__builtin_sqrtf(x)": 0x2C,
        "__builtin_copysignf(x, y)": 0x10, "-x": 0x10, "__builtin_fabsf(x)": 0x10, "__builtin_fminf(x, y)": 0x14,
        "__builtin_fmaxf(x, y)": 0x14, "x < y": 0x50, "x == y": 0x50, "(int)x": 0x60, "(float)n": 0x68,
    }  # fmt: skip
    lines = "".join(f"x = {expression};\n" for expression in expressions)
    image = image_of(tmp_path, f"volatile float x, y; volatile int n;\nint main(void) {{ {lines} return 0; }}")
    start, size = image.symbols["main"]
    found = {int(word) >> 25 for word in image.words[start // 4 : (start + size) // 4] if word & 0x7F == 0x0B}
    assert found == set(expressions.values())
    assert not any("sf" in name for name in image.symbols)
