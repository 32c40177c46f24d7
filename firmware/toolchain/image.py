"""An image: what the soft core's RAM holds when it starts, and what is known of it."""

import dataclasses
import functools
import io
import pathlib
from typing import NamedTuple

import numpy as np
from elftools.common.exceptions import ELFError
from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile

from firmware.toolchain.errors import ToolchainError

__all__ = ["Image", "Sizes", "Symbol"]

#: Sections that the linker script knows; another one would neither be loaded nor zeroed.
SECTIONS = {".text", ".rodata", ".settings", ".bss", ".noinit"}

#: Those whose contents :meth:`Image.patched` may change.
CONSTANT = {".rodata", ".settings"}


class Symbol(NamedTuple):
    """Where an object or function lies, bytes; linker symbols such as ``__stack_low`` have size 0."""

    address: int
    size: int


class Sizes(NamedTuple):
    """Bytes of RAM.

    ``rodata`` includes the settings and ``bss`` what is not initialised. ``stack`` is what is left for the stack
    of ``total``.
    """

    text: int
    rodata: int
    bss: int
    stack: int
    total: int

    @property
    def used(self):
        """All but the stack."""
        return self.total - self.stack


@dataclasses.dataclass(frozen=True)
class Image:
    """A linked program for the soft core.

    Parameters
    ----------
    name : str
        What it is called.
    elf : bytes
        The ELF file, linked by ``platform/riscv/link.ld``, its floating-point instructions redirected.

    Raises
    ------
    ToolchainError
        If ``elf`` is no such file.
    """

    name: str
    elf: bytes = dataclasses.field(repr=False)

    def __post_init__(self):
        try:
            sections = [(s.name, s["sh_flags"]) for s in self._file.iter_sections()]
            symbols = self.symbols
        except (ELFError, ValueError) as error:
            raise ToolchainError(f"{self.name}: not an image: {error}") from None
        for name, flags in sections:
            if flags & SH_FLAGS.SHF_ALLOC and name not in SECTIONS:
                raise ToolchainError(f"{self.name}: section {name} has no place in the linker script")
        missing = [name for name in ("__stack_low", "__stack_top") if name not in symbols]
        if missing or self._file["e_machine"] != "EM_RISCV":
            raise ToolchainError(f"{self.name}: not linked for this core")

    @functools.cached_property
    def _file(self):
        return ELFFile(io.BytesIO(self.elf))

    @functools.cached_property
    def symbols(self):
        """Dict of name to :class:`Symbol`; of equal names that of a global symbol, else the first."""
        table = self._file.get_section_by_name(".symtab")
        if table is None:
            raise ToolchainError(f"{self.name}: not an image: it has no symbols")
        found = {}
        for symbol in sorted(table.iter_symbols(), key=lambda s: s["st_info"]["bind"] == "STB_LOCAL"):
            kept = symbol["st_info"]["type"] in ("STT_FUNC", "STT_OBJECT", "STT_NOTYPE")
            if kept and symbol.name and not symbol.name.startswith(("$", ".L")):
                found.setdefault(symbol.name, Symbol(symbol["st_value"], symbol["st_size"]))
        return found

    @functools.cached_property
    def words(self):
        """Content of the RAM from its first word to the last that is not zero by design, array (n,), uint32."""
        segments = [s for s in self._file.iter_segments() if s["p_type"] == "PT_LOAD" and s["p_filesz"]]
        content = bytearray(-(-max(s["p_vaddr"] + s["p_filesz"] for s in segments) // 4) * 4)
        for segment in segments:
            start = segment["p_vaddr"]
            content[start : start + segment["p_filesz"]] = segment.data()
        words = np.frombuffer(bytes(content), dtype="<u4").astype(np.uint32)
        words.setflags(write=False)
        return words

    @functools.cached_property
    def sizes(self):
        """The image's :class:`Sizes`."""
        lengths = {s.name: s["sh_size"] for s in self._file.iter_sections()}
        low, top = self.symbols["__stack_low"].address, self.symbols["__stack_top"].address
        text, *rest = (lengths.get(name, 0) for name in (".text", ".rodata", ".settings", ".bss", ".noinit"))
        return Sizes(text, sum(rest[:2]), sum(rest[2:]), top - low, top)

    def patched(self, symbol, content):
        """The image with other contents of a constant object, as of ``settings``.

        Parameters
        ----------
        symbol : str
            Name of an object in ``.rodata`` or ``.settings``.
        content : bytes
            Its new contents, as many bytes as it has.

        Raises
        ------
        ToolchainError
            If there is no such object, or its size is another.
        """
        place = self.symbols.get(symbol)
        if place is None:
            raise ToolchainError(f"{self.name}: no symbol {symbol}")
        for section in self._file.iter_sections():
            offset = place.address - section["sh_addr"]
            if section.name in CONSTANT and 0 <= offset < section["sh_size"]:
                break
        else:
            raise ToolchainError(f"{self.name}: {symbol} is no constant object")
        if len(content) != place.size:
            raise ToolchainError(f"{self.name}: {symbol} has {place.size} bytes, not {len(content)}")
        start = section["sh_offset"] + offset
        return Image(self.name, self.elf[:start] + bytes(content) + self.elf[start + place.size :])

    def save(self, folder):
        """Write the image into ``folder``, as ``NAME.elf``, ``.bin``, ``.hex`` and ``.map``, and return the paths.

        ``.bin`` is the RAM's content, ``.hex`` the same for ``$readmemh``, a word a line, and ``.map`` lists address,
        size and name of every symbol.
        """
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        lines = sorted(f"{s.address:08x} {s.size:6} {name}\n" for name, s in self.symbols.items())
        contents = {
            "elf": self.elf,
            "bin": self.words.astype("<u4").tobytes(),
            "hex": "".join(f"{word:08x}\n" for word in self.words).encode(),
            "map": "".join(lines).encode(),
        }
        paths = [folder / f"{self.name}.{suffix}" for suffix in contents]
        for path, content in zip(paths, contents.values(), strict=True):
            path.write_bytes(content)
        return paths
