"""What goes wrong in a way that a user can mend."""

__all__ = ["ToolchainError"]


class ToolchainError(RuntimeError):
    """An image could not be built, read or changed; the message, one line, says why."""
