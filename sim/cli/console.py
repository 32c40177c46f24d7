"""Where tables and progress go: tables to standard output, progress to standard error if it is a terminal."""

import sys

import rich.progress
from rich.console import Console

__all__ = ["busy", "printer", "progress"]

_FILE_WIDTH = 120
"""Columns of a table where there is no terminal to measure."""


def printer(aside=False):
    """Console for tables; ``aside`` puts them on standard error, since standard output carries JSON."""
    stream = sys.stderr if aside else sys.stdout
    return Console(file=stream, width=None if stream.isatty() else _FILE_WIDTH, highlight=False)


def progress(items, description, total=None):
    """Yield ``items`` while a bar counts them."""
    console = Console(stderr=True)
    return rich.progress.track(
        items, description, total=total, console=console, transient=True, disable=not console.is_terminal
    )


def busy(description):
    """Context manager that turns a spinner on a terminal, for what has no measure."""
    console = Console(stderr=True, quiet=not sys.stderr.isatty())
    return console.status(description)
