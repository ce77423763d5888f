"""Studies in virtual time, as pandas frames. pandas is imported when a frame is made."""
import io
import os
import pathlib

from . import _thimble
from .sessions import as_settings


def _frame(table):
    import pandas

    return pandas.read_csv(table, float_precision="round_trip")


def study(session="paper-experiment-3", *, subjects=None, seed=None, order=None, changes=None, jobs=0, out=None, control=True,
          trajectories=False, overwrite=False):
    """Runs a session's trials by virtual subjects, and returns them as a pandas frame: the rows and columns of trials.csv.

    session: the name of a session, the path of a file, or a dictionary of its tables. subjects, seed, order ("shuffled", "williams"):
    instead of the session's. changes: dotted keys and numbers. jobs: threads, 0 is one per core; the trials do not depend on it.

    out: a folder. With it all files of `thimble study` are written there; control=False, trajectories=True and overwrite=True are its
    options. The columns are described in docs/studies.md.
    """
    common = (as_settings(session), changes or {}, subjects, seed, order, jobs)
    if out is None:
        return _frame(io.StringIO(_thimble.study_table(*common)))
    return read_trials(_thimble.study_folder(*common, os.fspath(out), control, trajectories, overwrite))


def read_trials(path):
    """The trials of a run or a study as a pandas frame. path: a table of trials, or the folder that holds trials.csv."""
    path = pathlib.Path(path)
    return _frame(path / "trials.csv" if path.is_dir() else path)
