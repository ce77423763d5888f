"""A log of messages as `thimble log export --hdf5` writes it, with h5py (Debian: python3-h5py).

usage: log_hdf5.py FILE

    thimble log export out/run/nodes/*_50ms.mcap --hdf5 out/run.h5 && /usr/bin/python3 examples/analysis/log_hdf5.py out/run.h5
"""

import signal
import sys

import h5py


def describe(name, item):
    """One line per column that has a unit, with the range of its values."""
    if isinstance(item, h5py.Dataset) and "unit" in item.attrs:
        values = item[:]
        print(f"{name}  {item.attrs['unit'].decode()}  {len(values)} values, {values.min()} to {values.max()}")


signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # a long list, of which `head` may have had enough
with h5py.File(sys.argv[1], "r") as file:
    file.visititems(describe)
