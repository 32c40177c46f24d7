"""All commands under one roof, and their errors as one line."""

import os
import sys

import typer
from typer.exceptions import TyperException

from sim.cli.bench import bench
from sim.cli.blocks import blobs, corners
from sim.cli.clocks import clocks
from sim.cli.demo import demo
from sim.cli.errors import UserError
from sim.cli.render import render
from sim.cli.report_command import report
from sim.cli.run import run
from sim.cli.sweep import sweep
from sim.pictures import PictureError

__all__ = ["main"]

app = typer.Typer(
    name="python -m sim",
    help="RasterPose, an FPGA sensor for markers, simulated from the Verilog it is built of.",
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
)
for command in (run, blobs, corners, render, demo, bench, clocks, report, sweep):
    app.command()(command)


def main(args=None):
    """Run a command line (None: that of the process) and return its exit code.

    0 is success, 1 a missed target of ``bench``, 2 something the user must change, said in one line on
    standard error, and 130 an interruption.
    """
    try:
        return app(sys.argv[1:] or ["--help"] if args is None else args, standalone_mode=False) or 0
    except TyperException as error:
        message = error.format_message()
    except (UserError, PictureError) as error:
        message = str(error)
    except (KeyboardInterrupt, typer.Abort):
        print("interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # Nobody reads on: the interpreter shall not complain at its end either.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    print("error:", " ".join(message.split()), file=sys.stderr)
    return 2
