"""skipped.py JUNIT_XML: why tests of a ctest run were skipped, and which packages, devices or kernel features would let them run.

A reason names a package as `package NAME`, or says `deploy/install-SOMETHING`; other reasons are needs in their own words."""

import re
import sys
import xml.etree.ElementTree

SHOWN = 3  # tests of one reason by name


def reason_of(output):
    """The words of GTEST_SKIP(), or the last line of a script that ended with the exit code for it."""
    told = re.search(r"^\S+:\d+: Skipped\n(.*?)\n*^\[  SKIPPED \]", output, re.M | re.S)
    lines = [line.strip() for line in (told.group(1) if told else output.strip().rsplit("\n", 1)[-1]).split("\n")]
    return " ".join(line for line in lines if line) or "it gave no reason"


def tests_by_reason(root):
    reasons = {}
    for case in root.iter("testcase"):
        if case.find("skipped") is not None:
            reasons.setdefault(reason_of(case.findtext("system-out", "")), []).append(case.get("name"))
    return reasons


def needs(reasons):
    """The lines that say what to do, packages in one."""
    packages, scripts, others = set(), set(), []
    for reason in reasons:
        named = re.findall(r"\bpackage ([a-z0-9][a-z0-9+.-]*[a-z0-9+])", reason)
        script = re.findall(r"deploy/install-packages [\w-]+|deploy/install-(?!packages)[\w-]+", reason)
        packages.update(named)
        scripts.update(script)
        if not named and not script:
            others.append(reason)
    return [*(["apt install " + " ".join(sorted(packages))] if packages else []), *sorted(scripts), *others]


def report(text):
    root = xml.etree.ElementTree.fromstring(text)
    reasons = tests_by_reason(root)
    if not reasons:
        return []
    lines = [f"{sum(map(len, reasons.values()))} of {len(list(root.iter('testcase')))} tests were skipped:"]
    for reason, names in sorted(reasons.items()):
        more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
        lines.append(f"  {reason}: {', '.join(names[:SHOWN])}{more}")
    return [*lines, "To run them, this machine needs:", *(f"  {need}" for need in needs(reasons))]


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8", errors="replace") as file:
        print("\n".join(report(file.read())))
