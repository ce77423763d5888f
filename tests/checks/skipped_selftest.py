"""Feeds tests/skipped.py results as ctest writes them."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(sys.argv[1]) / "tests"))
import skipped  # noqa: E402


def gtest(name, words):
    return (f'<testcase name="{name}" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/><system-out>'
            f"[ RUN      ] {name}\n/a/b.cpp:9: Skipped\n{words}\n\n[  SKIPPED ] {name} (0 ms)\n[  PASSED  ] 0 tests.\n"
            "</system-out></testcase>")


def suite(*cases):
    return f"<testsuite>{''.join(cases)}</testsuite>"


PASSED = '<testcase name="Good" status="run"><system-out>/a/b.cpp:9: Skipped\nnothing</system-out></testcase>'
SCRIPT = ('<testcase name="lane" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/><system-out>first words\n'
          "lane: skipped: no QEMU; run deploy/install-packages kernel-lane\n</system-out></testcase>")
SILENT = '<testcase name="S" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/><system-out/></testcase>'
GNUPLOT = [gtest(f"Figures.{n}", "gnuplot is not\ninstalled (package gnuplot-nox)") for n in "abcde"]

# (results, all lines that have to come out)
CASES = (
    (suite(PASSED), []),
    (suite(PASSED, SCRIPT),
     ["1 of 2 tests were skipped:", "  lane: skipped: no QEMU; run deploy/install-packages kernel-lane: lane",
      "To run them, this machine needs:", "  deploy/install-packages kernel-lane"]),
    (suite(*GNUPLOT, gtest("Root.Not", "root may open everything"), gtest("M.P", "no mpirun: package openmpi-bin")),
     ["7 of 7 tests were skipped:",
      "  gnuplot is not installed (package gnuplot-nox): Figures.a, Figures.b, Figures.c and 2 more",
      "  no mpirun: package openmpi-bin: M.P", "  root may open everything: Root.Not",
      "To run them, this machine needs:", "  apt install gnuplot-nox openmpi-bin", "  root may open everything"]),
    (suite(SILENT),
     ["1 of 1 tests were skipped:", "  it gave no reason: S", "To run them, this machine needs:", "  it gave no reason"]),
)

wrong = [(skipped.report(text), lines) for text, lines in CASES if skipped.report(text) != lines]
for said, wanted in wrong:
    print(f"said {said}\nwanted {wanted}")
print(f"{len(CASES)} results, {len(wrong)} wrong")
sys.exit(1 if wrong else 0)
