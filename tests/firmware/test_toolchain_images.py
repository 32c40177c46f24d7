"""``python -m firmware.toolchain``: which images there are, what is printed, and what is complained of."""

import pytest

from firmware.toolchain import ToolchainError, __main__, images
from firmware.toolchain.images import IMAGES, Recipe, build, register_header
from tests.firmware.toolchain_case import HANDLERS


@pytest.fixture
def small(tmp_path, monkeypatch):
    """A registry with one image, of a folder and a file."""
    (tmp_path / "app").mkdir()
    (tmp_path / "app" / "help.h").write_text("int help(void);\n")
    (tmp_path / "app" / "main.c").write_text('#include "help.h"\n' + HANDLERS + "int main(void) { return help(); }\n")
    (tmp_path / "more.c").write_text("int help(void);\nint help(void) { return VALUE; }\n")
    recipe = Recipe(folders=("app",), files=("more.c",), options={"defines": ("VALUE=3",)})
    monkeypatch.setattr(images, "FIRMWARE", tmp_path)
    monkeypatch.setitem(IMAGES, "small", recipe)
    return tmp_path


def test_sizes_and_paths_are_printed(small, capsys):
    assert __main__.main(["small", "--out", str(small / "out")]) == 0
    lines = capsys.readouterr().out.splitlines()
    sizes = build("small").sizes
    row = next(line.split() for line in lines if line.split()[:1] == ["small"])
    assert row == ["small", *(f"{n:,}" for n in (sizes.text, sizes.rodata, sizes.bss, sizes.used, 32768, sizes.stack))]
    assert lines[-4:] == [str(small / "out" / f"small.{suffix}") for suffix in ("elf", "bin", "hex", "map")]


def test_complaints_are_one_line(small, capsys):
    assert __main__.main(["nothing"]) == 1
    (small / "more.c").write_text(
        "int help(void);\nvolatile unsigned char a[40000];\nint help(void) { return a[a[0]]; }\n"
    )
    assert __main__.main(["small"]) == 1
    first, second = capsys.readouterr().err.splitlines()
    assert first == f"firmware: no image nothing: there is {', '.join(IMAGES)}"
    assert second == "firmware: small: ld.lld: error: the image leaves less than 2 KB of the RAM for the stack"


def test_folder_that_cannot_be_written(small, capsys):
    assert __main__.main(["small", "--out", str(small / "more.c")]) == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_unknown_image():
    with pytest.raises(ToolchainError) as caught:
        build("nothing")
    assert str(caught.value).startswith("no image nothing: there is ")


def test_register_header_is_kept():
    folder = register_header()
    assert (folder / "rasterpose_regs.h").is_file() and register_header() == folder


@pytest.mark.parametrize("name", sorted(IMAGES))
def test_every_image_fits(name):
    """Firmware and stack in 32 KB, as the project wants it."""
    sizes = build(name).sizes
    assert sizes.used + sizes.stack == 32 * 1024 and sizes.stack >= 2048
