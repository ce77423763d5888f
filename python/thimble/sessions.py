"""Sessions by name, and thimble.Session."""
import os
import pathlib

from . import _thimble
from .errors import UsageError

_FOLDER = pathlib.Path(__file__).absolute().parent / "sessions"


def session_names():
    """The sessions that come with Thimble, a list of names."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


def session_file(given):
    """The path of a session file: given itself where it is a file, or that of the session of this name."""
    text = os.fspath(given)
    if os.path.exists(text):
        return text
    if "/" not in text and (_FOLDER / f"{text}.toml").exists():
        return str(_FOLDER / f"{text}.toml")
    raise UsageError(f"{text}: there is no such session file, and those that come with the program are {', '.join(session_names())}")


def as_settings(session):
    """For the module in C++: None, a dictionary, or the path of a file."""
    return session if session is None or isinstance(session, dict) else session_file(session)


class Session(_thimble.Session):
    __doc__ = _thimble.Session.__doc__

    def __init__(self, session=None, *, hand="operator", changes=None):
        super().__init__(as_settings(session), hand=hand, changes=changes or {})
