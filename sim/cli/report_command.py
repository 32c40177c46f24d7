"""``report``: the evaluation as a page and as results.json."""

from typing import Annotated

import typer

from sim.cli import options
from sim.cli.console import printer, progress
from sim.cli.errors import reported
from sim.cli.files import checked_folder, checked_json, write_json

__all__ = ["report"]


def report(
    quick: Annotated[bool, typer.Option("--quick", help="Few frames: under two minutes.")] = False,
    out: Annotated[str, typer.Option(metavar="DIR", help="Folder for index.html and results.json.")] = (
        "build/out/report"
    ),
    workers: options.WorkersOption = -1,
    dask: options.DaskOption = None,
):
    """Compare the sensor with its rivals, redo the paper's experiments, and write one page about it.

    What was worked out is kept in build/out/evaluation, so an interrupted report goes on where it was.
    """
    from firmware.toolchain import ToolchainError
    from sim.engine import EngineError
    from sim.evaluation.pool import ClusterError
    from sim.evaluation.store import Store
    from sim.report.page import write_page
    from sim.report.results import FULL, QUICK, UnequalError, gather

    folder = checked_folder(out)
    checked_json(folder / "results.json")
    options.checked_workers(workers)
    with reported(ClusterError, EngineError, ToolchainError, UnequalError):
        results = gather(QUICK if quick else FULL, Store(), workers=workers, dask=dask, progress=progress)
    write_json(folder / "results.json", results)
    with reported(OSError, doing=f"cannot write to {folder}"):
        page = write_page(results, folder)
    printer().print(f"Look at {page}", markup=False, soft_wrap=True)
