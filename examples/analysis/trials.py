"""Trials of `thimble study` or `thimble run` with pandas (Debian: python3-pandas).

usage: trials.py FOLDER

    thimble study --out out/study && /usr/bin/python3 examples/analysis/trials.py out/study
"""

import pathlib
import sys

import pandas

folder = pathlib.Path(sys.argv[1])
# "#" begins a comment; an empty field is a measure that this trial does not have, such as the time of a beep that never came.
trials = pandas.read_csv(folder / "trials.csv", comment="#")

# One value per subject and condition first, then mean and standard deviation over subjects.
measures = ["penetration_mean_m", "penetration_max_m", "completion_time_s"]
subjects = trials.groupby(["delay_s", "modality", "subject"])[measures].mean()
table = subjects.groupby(["delay_s", "modality"]).agg(["mean", "std", "count"])

with pandas.option_context("display.width", 160, "display.max_columns", None):
    print(table)
