"""No two types of one name in headers that programs share: two of them in one program are one to the linker (the One
Definition Rule), which takes either's destructor for both. And no using-declaration of a name that its source does not use.

usage: type_names.py PROJECT_ROOT
"""

import re
import sys

from sources import ROOMS, code_only, read_tree, report

DEFINITION = re.compile(r"^(?:struct|class|enum class|enum) ([A-Z]\w*)(?: final)?(?: :[^:].*)?(?: \{.*)?$", re.MULTILINE)

USING = re.compile(r"^ *using (?:\w+::)+(\w+);", re.MULTILINE)


def unused(path, text):
    code = code_only(text)
    return [f"{path}: using {name} is of no use" for name in USING.findall(code) if len(re.findall(rf"\b{name}\b", code)) == 1]


def check(tree):
    first = {}
    findings = [finding for path, text in tree.items() if path.endswith(".cpp") for finding in unused(path, text)]
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
    sys.exit(report(check(sources), len(sources), "names of types and using-declarations"))
