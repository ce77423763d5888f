"""The exceptions of Thimble. Each has the words of the program's message, and the program's exit code as exit_code."""


class Error(Exception):
    """All exceptions of Thimble."""

    exit_code = 1


class RunError(Error, RuntimeError):
    """A run or a trial failed."""


class UsageError(Error, ValueError):
    """An argument, a key or a value is wrong."""

    exit_code = 2


class NetworkError(Error, ConnectionError):
    """A port is in use, or a peer is missing."""

    exit_code = 3


class RealtimeError(Error, RuntimeError):
    """A deadline was missed."""

    exit_code = 4


class DataError(Error, OSError):
    """A file cannot be read, written or trusted."""

    exit_code = 5


def of_code(code, words):
    kinds = {kind.exit_code: kind for kind in (UsageError, NetworkError, RealtimeError, DataError)}
    return kinds.get(code, RunError)(words)
