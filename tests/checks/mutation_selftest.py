"""The text handling of tests/nightly/mutation: what becomes of entries and of sources, and which entries are refused.

usage: mutation_selftest.py PROJECT_ROOT
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "nightly" / "mutants"))

from mutant_list import ListError, Mutant, path_of, read_list, with_survivors  # noqa: E402
from score import complaints, score_lines  # noqa: E402
from sources import report  # noqa: E402
from switches import INCLUDE, with_switches  # noqa: E402
from test_runs import first_failure  # noqa: E402


def mutant(old, new="", **others):
    return Mutant("room", others.pop("kind", "ordinary"), others.pop("file", "a.cpp"), old, new, **others)


LESS = mutant("if («a < b») f();", "a <= b")
DROP = mutant("«f();»")
N, M = LESS.number, DROP.number

# (the source, the mutants, the source with switches, or a part of the complaint behind a "!")
SWITCHED = (
    ("if (a < b) f();", [LESS], f"if ((MUTATED({N}) ? (a <= b) : (a < b))) f();"),
    ("if (a  <\n b)\n    f();", [LESS], f"if ((MUTATED({N}) ? (a <= b) : (a  <\n b)))\n    f();"),
    ("if (a < b) f();", [LESS, DROP], f"if ((MUTATED({N}) ? (a <= b) : (a < b))) {{ if (!MUTATED({M})) {{ f(); }} }}"),
    ("x = 1;", [m := mutant("«x = 1;»", "x = 2;")], f"{{ if (MUTATED({m.number})) {{ x = 2; }} else {{ x = 1; }} }}"),
    ("g(-x, y);", [m := mutant("g(«-x», y)", "x")], f"g((MUTATED({m.number}) ? (x) : (-x)), y);"),
    ("g(h(a, b) * y);", [m := mutant("«h(a, b)» * y", "1")], f"g((MUTATED({m.number}) ? (1) : (h(a, b))) * y);"),
    ("T a = T{};", [m := mutant("a = «T{}»", "t")], f"T a = (MUTATED({m.number}) ? (t) : (T{{}}));"),
    (
        "constexpr int k = 3;",
        [m := mutant("k = «3»;", "4")],
        f"const int k = (MUTATED({m.number}) ? (4) : (3));",
    ),
    (
        "constexpr int k[]{1,\n  3};",
        [m := mutant("1, «3»", "4")],
        f"const int k[]{{1,\n  (MUTATED({m.number}) ? (4) : (3))}};",
    ),
    (
        "static constexpr int k{3};",
        [m := mutant("k{«3»}", "4")],
        f"static inline const int k{{(MUTATED({m.number}) ? (4) : (3))}};",
    ),
    (
        "constexpr int f(int x) { return x + 1; }",
        [m := mutant("return «x + 1»;", "x - 1", in_constexpr=True)],
        f"constexpr int f(int x) {{ return (MUTATED_IN_CONSTEXPR({m.number}) ? (x - 1) : (x + 1)); }}",
    ),
    ("if (a > b) f();", [LESS], "!a.cpp: a < b -> a <= b: its text occurs 0 times"),
    ("if (a < b) f(); if (a < b) f();", [LESS], "!occurs 2 times"),
    ("x = y * a + b;", [mutant("y * «a + b»", "a - b")], "!part of a larger operand"),
    ("x = a + b * y;", [mutant("= «a + b» * y", "a - b")], "!part of a larger operand"),
    ("x = a;", [mutant("x = «a»;")], "!only a statement can be dropped"),
    ("x = a;", [mutant("x = a;", "b")], "!needs one mark"),
    ("x = a < b;", [mutant("«x = a» < b;", "c"), mutant("x = «a < b»;", "d")], "!their marks overlap"),
)

PATHS = ["common/a.cpp", "netem/b.cpp", "master/b.cpp", "tests/unit/a.cpp"]
# (the mutant's file, the path, or a part of the complaint)
FOUND = (("a.cpp", "common/a.cpp"), ("netem/b.cpp", "netem/b.cpp"), ("b.cpp", "!2 sources"), ("c.cpp", "!0 sources"))

# (text of a list, how many mutants, or a part of the complaint)
LISTS = (
    ('tests = ["u"]\n[[ordinary]]\nfile = "a.cpp"\nold = "«a»"\n[[rare]]\nfile = "a.cpp"\nold = "«b»"\n', 2),
    ('[[ordinary]]\nold = "«a»"\n', "!needs file and old"),
    ('[[ordinary]]\nfile = "a.cpp"\nold = "«a»"\nlod = ""\n', "!needs file and old"),
    ('[[often]]\nfile = "a.cpp"\nold = "«a»"\n', "!unknown table 'often'"),
    ("[[ordinary]\n", "!room.toml"),
)

# (output of a test program, its exit code, what counts as the first failure)
OUTPUTS = (
    ("[ RUN      ] A.b\n[       OK ] A.b\n", 0, ""),
    ("[ RUN      ] A.b\n[  FAILED  ] A.b (1 ms)\n[  FAILED  ] A.b\n", 1, "A.b"),
    ("[ RUN      ] A.b\n[       OK ] A.b\n[ RUN      ] A.c/1\n", -11, "A.c/1 (exit code -11)"),
    ("", 1, "start (exit code 1)"),
)


def outcome(work):
    try:
        return work()
    except ListError as error:
        return f"!{error}"


def disagrees(found, expected, about):
    agrees = expected[1:] in found if str(expected).startswith("!") and isinstance(found, str) else found == expected
    return [] if agrees else [f"{about!r}: {found!r}, expected {expected!r}"]


def score_disagreements():
    """Killed, survived, equivalent, and a survivor that the list knows."""
    mutants = [LESS, DROP, mutant("«c»", "d", equivalent="why"), mutant("«e»", "f", survives="why", kind="rare")]
    results = {one.number: {"killer": "A.b" if one is LESS else ""} for one in mutants}
    worse, outdated = complaints(mutants, results)
    found = [score_lines(mutants, results)[2:], worse, outdated]
    expected = [["| ordinary | 3 | 1 | 1 of 2 | 50.0 % | 90 % |", "| rare | 1 | 0 | 0 of 1 | 0.0 % | 75 % |"], [DROP], []]
    killed = complaints(mutants[2:], {one.number: {"killer": "A.b"} for one in mutants})
    return disagrees(found, expected, "score") + disagrees([len(part) for part in killed], [0, 2], "outdated words")


def acceptance_disagreements():
    """`survives` goes to the survivor's entry and to no other one."""
    entries = ['tests = ["u"]', '# Some.\n\n[[rare]]\nfile = "a.cpp"\nold = "«a;»"', '[[rare]]\nfile = "a.cpp"\nold = "«b;»"\n']
    text = "\n\n".join(entries)
    survivor = read_list("room", text)[0][1]
    found = with_survivors("room", text, {survivor.number}, "why")
    return disagrees(found, text + 'survives = "why"\n', text)


def main():
    wrong = []
    for source, mutants, expected in SWITCHED:
        expected = expected if expected.startswith("!") else INCLUDE + expected
        wrong += disagrees(outcome(lambda: with_switches(source, mutants)), expected, source)
    for file, expected in FOUND:
        wrong += disagrees(outcome(lambda: path_of(mutant("«a»", file=file), PATHS)), expected, file)
    for text, expected in LISTS:
        wrong += disagrees(outcome(lambda: len(read_list("room", text)[0])), expected, text)
    for output, code, expected in OUTPUTS:
        wrong += disagrees(first_failure(output, code), expected, output)
    wrong += score_disagreements() + acceptance_disagreements()
    return report(wrong, len(SWITCHED) + len(FOUND) + len(LISTS) + len(OUTPUTS) + 2, "mutation self-test", of="cases")


if __name__ == "__main__":
    sys.exit(main())
