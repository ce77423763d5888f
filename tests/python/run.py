"""run.py FOLDER [OPTIONS OF PYTEST...]: the tests of the Python package; exit code 77 where their packages are missing."""
import importlib.util
import sys

missing = [name for name in ("numpy", "pandas", "pytest") if importlib.util.find_spec(name) is None]
if missing:
    print("there is no " + ", no ".join(f"{name} (package python3-{name})" for name in missing))
    sys.exit(77)

import pytest

sys.exit(pytest.main(["-q", "-rs", "-p", "no:cacheprovider", *sys.argv[1:]]))
