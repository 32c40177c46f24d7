"""Files that commands write: checked before the work that fills them."""

import json
import pathlib
import re
import sys

from sim.cli.errors import UserError, reported
from sim.pictures import write_picture

__all__ = ["STDOUT", "checked_file", "checked_folder", "checked_json", "save_picture", "unique_names", "write_json"]

# Lists of plain values, which are easier to read on one line; the line breaks keep it off what is in strings.
_NUMBERS = re.compile(r'\[\n([^\[\]{}"]*)\n *\]')

STDOUT = "-"
"""As the name of a JSON file: standard output."""


def checked_folder(path):
    """Make a folder, with its parents, or complain; returns it as a Path."""
    folder = pathlib.Path(path)
    with reported(OSError, ValueError, doing=f"cannot write to {folder}"):
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def checked_json(path):
    """Complain now if a JSON file could not be written later; None and ``-`` are in order."""
    if path not in (None, STDOUT):
        checked_file(path)


def checked_file(path):
    """Complain now if a file could not be written later, and make its folder."""
    if pathlib.Path(path).is_dir():
        raise UserError(f"cannot write {path}: is a directory")
    checked_folder(pathlib.Path(path).parent)
    with reported(OSError, ValueError, doing=f"cannot write {path}"), open(path, "a"):
        pass


def write_json(path, data):
    """Write ``data`` as JSON to a file or, where it is ``-``, to standard output."""
    text = _NUMBERS.sub(
        lambda found: "[" + " ".join(found[1].split()) + "]", json.dumps(data, indent=1, allow_nan=False)
    )
    text += "\n"
    if path == STDOUT:
        sys.stdout.write(text)
        return
    with reported(OSError, doing=f"cannot write {path}"):
        pathlib.Path(path).write_text(text)


def save_picture(path, image):
    """Write a picture or complain."""
    with reported(OSError, doing=f"cannot write {path}"):
        write_picture(path, image)


def unique_names(paths):
    """A name for each file's products: its stem, and with a number where another file has the same one."""
    names = []
    for path in paths:
        stem = pathlib.Path(path).stem
        name, number = stem, 1
        while name in names:
            number += 1
            name = f"{stem}-{number}"
        names.append(name)
    return names
