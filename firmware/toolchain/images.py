"""The images of this project, by name."""

import dataclasses
import hashlib
import pathlib

from firmware.toolchain.compile import FIRMWARE, build_image
from firmware.toolchain.errors import ToolchainError
from sim.engine.build import OUT, locked

__all__ = ["IMAGES", "Recipe", "build", "register_header"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recipe:
    """What an image is made of.

    Parameters
    ----------
    folders : tuple of str
        Folders in ``firmware/`` all of whose C files belong to it, and from which headers are included.
    files : tuple of str
        Further C files in ``firmware/``.
    includes : tuple of str
        Further folders in ``firmware/`` from which headers are included.
    options : dict
        Keyword arguments of :func:`~firmware.toolchain.compile.build_image`.
    """

    folders: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    includes: tuple[str, ...] = ()
    options: dict = dataclasses.field(default_factory=dict)


def _measuring(*files, **options):
    """Recipe of a program that measures: ``files`` of ``firmware/measure``, over the pose library."""
    files = tuple(f"measure/{file}.c" for file in ("program", *files))
    return Recipe(folders=("pose",), files=files, includes=("sensor",), options=options)


def _pose_clocks(method, floats, *, functions="exact", defines=()):
    defines = (f"POSE=pose_{method}", f"POSE_FUNCTIONS=POSE_{functions.upper()}", *defines)
    library = functions == "library"
    # With -O2 the C library's functions and software floats together leave no room for the stack.
    optimise = "-Os" if library and floats == "software" else "-O2"
    options = {"floats": floats, "defines": defines, "library_math": library, "optimise": optimise}
    return _measuring("pose_clocks", "pose_job", **options)


def _function_clocks(floats, **options):
    return _measuring("function_clocks", "function_job", floats=floats, **options)


_FLOATS = ("hardware", "software")
_FUNCTIONS = ("exact", "approximations", "library")

#: Name to recipe: the sensor's firmware, and programs that measure clocks, whose names end with how they do floats.
IMAGES = {
    "sensor": Recipe(folders=("pose", "sensor")),
    **{f"centred-{floats}": _pose_clocks("centred", floats) for floats in _FLOATS},
    **{
        f"classic-{functions}-{floats}": _pose_clocks("classic", floats, functions=functions)
        for functions in _FUNCTIONS
        for floats in _FLOATS
    },
    "covariance-hardware": _pose_clocks("centred", "hardware", defines=("COVARIANCE",)),
    **{
        f"functions-library-{floats}": _function_clocks(floats, defines=("LIBRARY",), library_math=True)
        for floats in _FLOATS
    },
    "functions-approximations-hardware": _function_clocks("hardware"),
    "operations-hardware": _measuring("operation_clocks"),
}


def register_header():
    """Folder of ``rasterpose_regs.h``, made from ``hdl/registers.rdl`` if that has changed since."""
    from hdl.config import SensorConfig
    from hdl.regs import docs

    hardware = pathlib.Path(docs.__file__).parents[1]
    digest = hashlib.sha256()
    for path in [hardware / "config.py", *sorted((hardware / "regs").glob("*.py")), *sorted(hardware.rglob("*.rdl"))]:
        digest.update(repr((path.name, path.read_bytes())).encode())
    folder = OUT / "firmware" / f"registers-{digest.hexdigest()[:20]}"
    with locked(folder) as scratch:
        if scratch is not None:
            docs.write_docs(SensorConfig(), scratch)
    return folder


def build(name):
    """The image called ``name``, a key of :data:`IMAGES`.

    Raises
    ------
    ToolchainError
        If there is no such image, or it cannot be built.
    """
    if name not in IMAGES:
        raise ToolchainError(f"no image {name}: there is {', '.join(IMAGES)}")
    recipe = IMAGES[name]
    folders = [FIRMWARE / folder for folder in recipe.folders]
    sources = [path for folder in folders for path in sorted(folder.glob("*.c"))]
    sources += [FIRMWARE / file for file in recipe.files]
    folders += [FIRMWARE / folder for folder in recipe.includes]
    return build_image(sources, name=name, includes=(*folders, register_header()), **recipe.options)
