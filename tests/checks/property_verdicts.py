"""rc::check() returns whether the property holds and fails no test by itself: its result must be asserted.

usage: property_verdicts.py PROJECT_ROOT
"""

import re
import sys

from sources import code_only, read_tree, report

PROPERTY = re.compile(r"(?P<asserted>\b(?:EXPECT|ASSERT)_TRUE\(\s*)?(?:::)?(?<!\w)rc::check\b")


def check(tree):
    findings = []
    for path, text in tree.items():
        code = code_only(text)
        for match in PROPERTY.finditer(code):
            if match["asserted"] is None:
                line = code.count("\n", 0, match.start()) + 1
                findings.append(f"{path}:{line}: the result is not asserted: write EXPECT_TRUE(rc::check(...))")
    return findings


if __name__ == "__main__":
    sources = read_tree(sys.argv[1])
    sys.exit(report(check(sources), len(sources), "verdicts of properties"))
