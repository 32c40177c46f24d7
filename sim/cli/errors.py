"""What the user did wrong, as one line."""

import contextlib

__all__ = ["UserError", "reported"]


class UserError(Exception):
    """Ends the command with ``error: <message>`` on standard error and exit code 2."""


@contextlib.contextmanager
def reported(*kinds, doing=None):
    """Turn exceptions of these kinds into a UserError of one line, after what was being done."""
    try:
        yield
    except kinds as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        line = " ".join(reason.split())
        raise UserError(f"{doing}: {line}" if doing else line) from error
