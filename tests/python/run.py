"""run.py PATH [OPTIONS OF PYTEST...]: tests of the Python package; exit code 77 where what they need is missing, so that all were skipped."""
import importlib.util
import sys

missing = [name for name in ("numpy", "pandas", "pytest") if importlib.util.find_spec(name) is None]
if missing:
    print("there is no " + ", no ".join(f"{name} (package python3-{name})" for name in missing))
    sys.exit(77)

import pytest


class Tally:
    """Whether any test ran, and why others did not."""
    ran, reason = False, "there is no test"

    def pytest_runtest_logreport(self, report):
        self.ran = self.ran or report.when == "call" and not report.skipped
        if report.skipped:
            self.reason = report.longrepr[2].removeprefix("Skipped: ")


tally = Tally()
code = pytest.main(["-q", "-rs", "-p", "no:cacheprovider", *sys.argv[1:]], plugins=[tally])
if code == 0 and not tally.ran:
    print(tally.reason)
    code = 77
sys.exit(code)
