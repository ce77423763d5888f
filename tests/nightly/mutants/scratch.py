"""A scratch copy of the checkout with every mutant in it, and its one build."""

import pathlib
import re
import subprocess
import sys

from mutant_list import ROOMS, ListError, path_of
from switches import HEADER, with_switches

ROOT = pathlib.Path(__file__).resolve().parents[3]
# Assertions stay; unity builds and tests without optimisation (THIMBLE_SELDOM) halve the time. No warnings: mutants make them.
OPTIONS = ("-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -w", "-DCMAKE_UNITY_BUILD=ON",
           "-DCMAKE_UNITY_BUILD_BATCH_SIZE=8", "-DTHIMBLE_BENCH=OFF", "-DTHIMBLE_MPI=OFF",
           "-DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST")


def sources(root=ROOT):
    """Needs no git: a packed source has none."""
    return [path.relative_to(root).as_posix() for room in ROOMS for path in sorted((root / room).rglob("*.[ch]pp"))]


def tracked_files(root=ROOT):
    listed = subprocess.run(["git", "ls-files", "-z", "-co", "--exclude-standard"], cwd=root, capture_output=True, check=True)
    return [path for path in listed.stdout.decode().split("\0") if path and (root / path).is_file()]


def mutated_texts(mutants, root, paths):
    """{path: text with its switches}; every entry that cannot be used is named at once."""
    by_path, complaints = {}, []
    for mutant in mutants:
        try:
            path = path_of(mutant, paths)
            with_switches((root / path).read_text(encoding="utf-8"), [mutant])
            by_path.setdefault(path, []).append(mutant)
        except ListError as error:
            complaints.append(str(error))
    if complaints:
        raise ListError("\n".join(complaints))
    return {path: with_switches((root / path).read_text(encoding="utf-8"), ones) for path, ones in by_path.items()}


def _write_changed(path, data, mode):
    """A file that has not changed keeps its time, so that the build leaves it alone."""
    if not path.is_file() or path.read_bytes() != data:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        path.chmod(mode)


def copy_tree(mutants, tree, root=ROOT):
    """Makes `tree` the checkout's copy with the mutants' switches."""
    paths = tracked_files(root)
    texts = mutated_texts(mutants, root, paths)
    for path in paths:
        data = texts[path].encode() if path in texts else (root / path).read_bytes()
        _write_changed(tree / path, data, (root / path).stat().st_mode)
    _write_changed(tree / "mutated.hpp", HEADER.encode(), 0o644)
    kept = {*paths, "mutated.hpp"}
    for file in [file for file in tree.rglob("*") if file.is_file()]:
        if file.relative_to(tree).as_posix() not in kept:
            file.unlink()


def _must(command):
    print(" ".join(map(str, command)), file=sys.stderr)
    with subprocess.Popen(command, stdout=sys.stderr) as child:
        try:
            code = child.wait()
        except BaseException:
            child.terminate()  # ninja then ends its compilers; one that is left over would write into the next build
            child.wait()
            raise
    if code:
        raise ListError("the scratch build failed; a compiler's message that names a mutant's line is about its entry")


def configure(tree, build):
    """The unit test programs of the build."""
    _must(["cmake", "-G", "Ninja", "-S", tree, "-B", build, *OPTIONS])
    targets = subprocess.run(["ninja", "-C", build, "-t", "targets", "all"], capture_output=True, text=True, check=True).stdout
    return sorted(set(re.findall(r"^bin/(unit_\w+|same_bits_tests):", targets, re.MULTILINE)))


def build_programs(build, programs, jobs):
    _must(["ninja", "-C", build, f"-j{jobs}", "--quiet", *programs])
