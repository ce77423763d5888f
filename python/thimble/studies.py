"""Studies and boards in virtual time, as pandas frames. pandas is imported when a frame is made."""
import io
import os
import pathlib
import tempfile

from . import _thimble
from .sessions import as_settings


def _pandas():
    """Called before the work, which may take hours."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError("frames need pandas: apt install --no-install-recommends python3-pandas, or pip install pandas") from error
    return pandas


def _frame(table):
    return _pandas().read_csv(table, float_precision="round_trip")


def _read(path, name):
    """The table at this path, or of this name in a folder."""
    path = pathlib.Path(path)
    return _frame(path / name if path.is_dir() else path)


def study(session="paper-experiment-3", *, subjects=None, seed=None, order=None, changes=None, jobs=0, out=None, control=True,
          trajectories=False, overwrite=False):
    """Runs a session's trials by virtual subjects, and returns them as a pandas frame: the rows and columns of trials.csv.

    session: the name of a session, the path of a file, or a dictionary of its tables. subjects, seed, order ("shuffled", "williams"):
    instead of the session's. changes: dotted keys and numbers. jobs: threads, 0 is one per core; the trials do not depend on it.

    out: a folder. With it all files of `thimble study` are written there; control=False, trajectories=True and overwrite=True are its
    options. The columns are described in docs/studies.md.
    """
    _pandas()
    common = (as_settings(session), changes or {}, subjects, seed, order, jobs)
    if out is None:
        return _frame(io.StringIO(_thimble.study_table(*common)))
    return read_trials(_thimble.study_folder(*common, os.fspath(out), control, trajectories, overwrite))


def read_trials(path):
    """The trials of a run or a study as a pandas frame. path: a table of trials, or the folder that holds trials.csv."""
    return _read(path, "trials.csv")


def board(*, plugins=(), only=(), trials=30, seed=1, jobs=0, out=None, overwrite=False):
    """Runs controllers and codecs in the conditions of `thimble board`, and returns the rows and columns of board.csv as a pandas frame.

    plugins: files of controllers of your own (docs/howto/controller.md). only: names of controllers, codecs and conditions, such as
    ["HF", "wave", "50ms"]; a kind of which none is named stays whole. trials: of each row. jobs: threads, 0 is one per core; the rows do
    not depend on it. out: a folder that keeps board.csv; overwrite=True replaces one that is there.

    Each measure has its mean, and 90 % intervals in columns that end in _low and _high. NaN: not measured. status is "ok", or why not.
    """
    _pandas()
    with tempfile.TemporaryDirectory() as scratch:
        folder = os.path.join(scratch, "board") if out is None else os.fspath(out)
        shipped = str(pathlib.Path(__file__).parent / "board")
        _thimble.board_folder(shipped, [os.fspath(file) for file in plugins], list(only), trials, seed, jobs, folder, overwrite)
        return read_board(folder)


def read_board(path):
    """The rows of `thimble board` as a pandas frame. path: a board.csv, or the folder that holds it."""
    return _read(path, "board.csv")
