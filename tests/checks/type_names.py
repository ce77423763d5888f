"""No two types of one name in headers that programs share: two of them in one program are one to the linker (the One
Definition Rule), which takes either's destructor for both.

usage: type_names.py PROJECT_ROOT
"""

import re
import sys

from sources import ROOMS, read_tree, report

DEFINITION = re.compile(r"^(?:struct|class|enum class|enum) ([A-Z]\w*)(?: final)?(?: :[^:].*)?(?: \{.*)?$", re.MULTILINE)


def check(tree):
    first = {}
    findings = []
    for path, text in sorted(tree.items()):
        if path.split("/")[0] not in ROOMS or not path.endswith(".hpp"):
            continue
        for name in DEFINITION.findall(text):
            if name in first and first[name] != path:
                findings.append(f"{path}: {name} is also a type of {first[name]}")
            first.setdefault(name, path)
    return findings


if __name__ == "__main__":
    sources = read_tree(sys.argv[1])
    sys.exit(report(check(sources), len(sources), "type names"))
