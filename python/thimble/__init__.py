"""Thimble in Python: networks, tissue, sessions in virtual time, studies and logs. The manual is docs/python.md.

Times are seconds, positions metres, forces newtons, as each name says. z points into the tissue; a negative force resists insertion.
"""
from . import lock_step
from ._thimble import LinkModel, Scene, __version__, read_log
from .environment import NeedleEnv
from .errors import DataError, Error, NetworkError, RealtimeError, RunError, UsageError
from .sessions import Session, session_file, session_names
from .studies import board, read_board, read_trials, study

__all__ = ["DataError", "Error", "LinkModel", "NeedleEnv", "NetworkError", "RealtimeError", "RunError", "Scene", "Session", "UsageError",
           "board", "lock_step", "read_board", "read_log", "read_trials", "session_file", "session_names", "study"]
