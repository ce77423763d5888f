"""Feeds every rule small trees that break it, and their closest neighbours that do not."""

import contextlib
import io
import sys

import additions
import file_sizes
import include_directions
import library_functions
import property_verdicts
import purity
import type_names
from sources import ROOMS, report

HEADERS = {f"{room}/a.hpp": "#pragma once\n" for room in (*ROOMS, "bench", "tests")}
HEADERS |= {"session/records/a.hpp": "#pragma once\n", "session/run/a.hpp": "#pragma once\n"}
HEADERS["common/shared.hpp"] = "struct Shared {\n"

# (check, file, its text, part of the finding it must make, or None where it must make none)
CASES = (
    (include_directions, "common/b.cpp", '#include "common/a.hpp"\n', None),
    (include_directions, "common/b.cpp", '#include "netem/a.hpp"\n', "common/ must not know netem/"),
    (include_directions, "common/b.cpp", '#include "session/a.hpp"\n', "common/ must not know session/"),
    (include_directions, "netem/b.cpp", '#include "common/a.hpp"\n#include "netem/a.hpp"\n', None),
    (include_directions, "netem/b.cpp", '#include "master/a.hpp"\n', "netem/ must not know master/"),
    (include_directions, "master/devices/b.hpp", '#include "master/a.hpp"\n', None),
    (include_directions, "master/devices/b.hpp", '\n#include "slave_sim/a.hpp"\n', "b.hpp:2: master/ must not"),
    (include_directions, "slave_sim/b.cpp", '#  include "visual_node/a.hpp"\n', "slave_sim/ must not know visual"),
    (include_directions, "visual_node/b.cpp", '#include "cutaneous_node/a.hpp"\n', "must not know cutaneous_node/"),
    (include_directions, "cutaneous_node/b.cpp", '#include "session/a.hpp"\n', "must not know session/"),
    (include_directions, "thimble/b.cpp", '#include "browser/a.hpp"\n', "thimble/ must not know browser/"),
    (include_directions, "python/b.cpp", "".join(f'#include "{room}/a.hpp"\n' for room in ROOMS), None),
    (include_directions, "session/b.cpp", '#include "stability/a.hpp"\n', None),
    (include_directions, "stability/b.cpp", '#include "session/a.hpp"\n', "stability/ must not know session/"),
    (include_directions, "session/b.cpp", '#include "analysis/a.hpp"\n', "session/ must not know analysis/"),
    (include_directions, "session/run/b.cpp", '#include "session/records/a.hpp"\n', None),
    (include_directions, "session/records/b.cpp", '#include "session/run/a.hpp"\n', "session/records must not know session/run"),
    (include_directions, "session/records/c/b.cpp", '#include "session/run/a.hpp"\n', "session/records must not know session/run"),
    (include_directions, "session/new/b.cpp", '#include "session/run/a.hpp"\n', "session/new has no rank"),
    (include_directions, "analysis/claims/b.cpp", '#include "analysis/a.hpp"\n', "analysis/claims must not know analysis/."),
    (include_directions, "netem/stages/b.cpp", '#include "netem/a.hpp"\n', None),
    (include_directions, "thimble/b.cpp", '#include "tests/a.hpp"\n', "thimble/ must not know tests/"),
    (include_directions, "bench/b.cpp", '#include "study/a.hpp"\n', None),
    (include_directions, "bench/b.cpp", '#include "tests/a.hpp"\n', "bench/ must not know tests/"),
    (include_directions, "tests/b.cpp", '#include "study/a.hpp"\n', None),
    (include_directions, "tests/b.cpp", '#include "bench/a.hpp"\n', None),
    (include_directions, "thimble/b.cpp", '#include "bench/a.hpp"\n', "thimble/ must not know bench/"),
    (include_directions, "tests/b.cpp", '#include "a.hpp"\n', "not written from the project's root"),
    (include_directions, "netem/b.cpp", '#include "../common/a.hpp"\n', "not written from the project's root"),
    (include_directions, "netem/b.cpp", '#include "common/gone.hpp"\n', "does not exist"),
    (include_directions, "netem/b.cpp", "#include <common/a.hpp>\n", "a project header in <>"),
    (include_directions, "netem/b.cpp", "#include <vector>\n", None),
    (include_directions, "netem/b.cpp", '// #include "master/a.hpp"\n', None),
    (include_directions, "netem/b.cpp", '/*\n#include "master/a.hpp"\n*/\n', None),
    (include_directions, "common/b.cpp", '#include "messages_generated.h"\n', None),
    (include_directions, "master/b.cpp", '#include "messages_generated.h"\n', "belongs to common"),
    (purity, "master/master_node.cpp", "auto t = std::chrono::steady_clock::now();\n", "steady_clock is a clock"),
    (purity, "common/flow.cpp", "auto t = std::chrono::system_clock::now();\n", "system_clock is a clock"),
    (purity, "netem/relay_process.cpp", "clock_gettime(CLOCK_MONOTONIC, &ts);\n", "clock_gettime is a clock"),
    (purity, "slave_sim/trial.cpp", "gettimeofday(&tv, nullptr);\n", "gettimeofday is a clock"),
    (purity, "slave_sim/trial.cpp", "\n\nauto t = time(nullptr);\n", "trial.cpp:3: time(nullptr is a clock"),
    (purity, "slave_sim/trial.cpp", "auto t = std::time(&t0);\n", "is a clock"),
    (purity, "slave_sim/trial.cpp", "std::this_thread::sleep_for(1ms);\n", "sleep_for is a clock"),
    (purity, "slave_sim/trial.cpp", "sleep(1);\n", "is a clock"),
    (purity, "slave_sim/trial.cpp", "// a steady_clock would be wrong here\n", None),
    (purity, "slave_sim/trial.cpp", 'log("time(nullptr)");\n', None),
    (purity, "slave_sim/trial.cpp", "const auto contact_time_s = contact_time(0.5);\n", None),
    (purity, "slave_sim/trial.cpp", "const int n = 1'000; // it's steady_clock\nx('a');\n", None),
    (purity, "slave_sim/trial.cpp", "const int n = 1'000; steady_clock::now(); x('a');\n", "is a clock"),
    (purity, "slave_sim/trial.cpp", 'auto s = R"(steady_clock)"; steady_clock c;\n', "is a clock"),
    (purity, "common/runtime/wall_clock.cpp", "clock_gettime(CLOCK_MONOTONIC, &ts);\n", None),
    (purity, "netem/main.cpp", "std::chrono::steady_clock::now();\n", "steady_clock is a clock"),
    (purity, "netem/main.cpp", 'file << report.dump(2);\n', "is a JSON writer that throws"),
    (purity, "netem/main.cpp", "file << json_text(report, 2);\n", None),
    (purity, "common/json_text.hpp", "return json.dump(indent);\n", None),
    (purity, "tests/b.cpp", "std::chrono::steady_clock::now();\n", None),
    (purity, "visual_node/visual_node.hpp", "#include <sys/socket.h>\n", "is a socket"),
    (purity, "visual_node/visual_node.cpp", "int fd = socket(AF_INET, SOCK_DGRAM, 0);\n", "is a socket"),
    (purity, "visual_node/visual_process.cpp", "recv(fd, p, n, 0);\n", "is a socket"),
    (purity, "common/runtime/udp_channel.cpp", "int fd = socket(AF_INET, SOCK_DGRAM, 0);\n", None),
    (purity, "visual_node/visual_node.cpp", "std::ofstream out(path);\n", "is a file"),
    (purity, "visual_node/visual_node.cpp", "#include <filesystem>\n", "is a file"),
    (purity, "visual_node/visual_node.cpp", 'FILE* f = fopen("x", "r");\n', "is a file"),
    (purity, "session/results.cpp", "std::ofstream out(path);\n", None),
    (purity, "common/random.cpp", "std::random_device device;\n", "is the machine's random numbers"),
    (purity, "common/random.cpp", "int x = std::rand();\n", "is the machine's random numbers"),
    (purity, "common/random.cpp", "int x = operand(1);\n", None),
    (purity, "common/runtime/instance.cpp", "std::random_device device;\n", None),
    (purity, "master/hand.cpp", "std::normal_distribution<double> d;\n", "differ between libraries"),
    (purity, "master/hand.cpp", "long double x = 0;\n", "differ between libraries"),
    (purity, "master/hand.cpp", "return std::exp(x);\n", "std::exp is a function whose last bits depend"),
    (purity, "thimble/hand.cpp", "values = std::transform(a, b, std::sinf);\n", "std::sinf is a function"),
    (purity, "stability/root.cpp", "    using std::atan2, std::sqrt;\n", "std::atan2 is a function"),
    (purity, "stability/root.cpp", "std::complex<double> z;\n", "std::complex is a function"),
    (purity, "netem/link.cpp", "return pow (x, 2);\n", "is a function of C"),
    (purity, "netem/link.cpp", "return 1 - ::tanh(x);\n", "is a function of C"),
    (purity, "netem/link.cpp", "#include <math.h>\n", "is a function whose last bits depend"),
    (purity, "netem/link.cpp", "return portable::exp(x) + std::sqrt(x) + std::log_file + file->log(x);\n", None),
    (purity, "netem/link.cpp", "spdlog::log(level, text); fmt::arg(name, 1); explain(x);\n", None),
    (purity, "stability/root.cpp", "return exp(Precise(x));\n", None),
    (purity, "visual_node/window/sphere.cpp", "return std::cos(x) + sinf(x);\n", None),
    (purity, "visual_node/hand.cpp", "return std::cos(x);\n", "std::cos is a function"),
    (file_sizes, "master/long.cpp", "\n" * 401, "401 lines"),
    (file_sizes, "master/long.cpp", "\n" * 400, None),
    (property_verdicts, "tests/b.cpp", "rc::check([] {});\n", "b.cpp:1: the result is not asserted"),
    (property_verdicts, "tests/b.cpp", "{\n    ::rc::check([] {});\n}\n", "b.cpp:2: the result is not"),
    (property_verdicts, "tests/b.cpp", "(void)rc::check([] {});\n", "is not asserted"),
    (property_verdicts, "tests/b.cpp", "using rc::check;\n", "is not asserted"),
    (property_verdicts, "tests/b.cpp", "EXPECT_TRUE(true);\nrc::check([] {});\n", "b.cpp:2: the result is not"),
    (property_verdicts, "tests/b.cpp", "EXPECT_TRUE(rc::check([] {}));\n", None),
    (property_verdicts, "tests/b.cpp", "ASSERT_TRUE(\n    ::rc::check([] {}));\n", None),
    (property_verdicts, "tests/b.cpp", "RC_GTEST_PROP(A, B, ()) {}\n// rc::check([] {});\n", None),
    (type_names, "common/b.hpp", "struct Grip {};\nclass Hand;\nstruct Hand {\n", None),
    (type_names, "netem/b.hpp", "struct Shared {\n", "Shared is also a type of common/shared.hpp"),
    (type_names, "netem/b.hpp", "class Shared final : public Other {\n", "Shared is also"),
    (type_names, "netem/b.hpp", "enum class Shared : std::uint8_t {\n", "Shared is also"),
    (type_names, "netem/b.hpp", "    struct Shared {\n    };\n", None),
    (type_names, "netem/b.cpp", "struct Shared {\n", None),
    (type_names, "netem/b.cpp", "using std::chrono::seconds;\n// seconds\n", "using seconds is of no use"),
    (type_names, "netem/b.cpp", "    using std::exp;\n    return exp(x);\n", None),
)

_FILE = "--- /dev/null\n+++ b/slave_sim/gel.cpp\n@@ -0,0 +1 @@\n+int gel;\n"
_DIFF = "--- a/slave_sim/list.hpp\n+++ b/slave_sim/list.hpp\n@@ -2,1 +2,2 @@\n one\n+gel\n@@ -3 +4 @@\n-two\n+more\n"
_LIST = "zero\none\ntwo\n"

# (patch, list that it changes, part of the complaint, or None where there must be none)
ADDITIONS = (
    (_FILE + _DIFF, _LIST, None),
    (_DIFF + _FILE, _LIST, None),
    ("", _LIST, "no patch changes anything"),
    (_FILE + _DIFF.replace("@@ -2,1 +2,2 @@", "@@"), _LIST, "changes slave_sim/list.hpp at no place"),
    (_FILE + _FILE + _DIFF, _LIST, "makes slave_sim/gel.cpp, which is there"),
    (_FILE.replace("gel.cpp", "list.hpp") + _DIFF, _LIST, "makes slave_sim/list.hpp, which is there"),
    (_FILE + _DIFF.replace("list.hpp", "lost.hpp"), _LIST, "changes slave_sim/lost.hpp, which is not there"),
    (_FILE + _DIFF, _LIST.replace("two", "twofold"), "that are there 0 times"),
    (_FILE + _DIFF, _LIST + "one\n", "that are there 2 times"),
    (_FILE + _DIFF.replace(" one\n", ""), _LIST, "other numbers of lines"),
    (_FILE + _DIFF.replace("-2,1 +2,2", "-2,0 +2").replace(" one\n", ""), _LIST, "that are there"),
)


def addition_disagreement(patch, text, expected):
    try:
        files = additions.make([patch], lambda path: text if path == "slave_sim/list.hpp" else None)
    except additions.Mismatch as mismatch:
        return None if expected and expected in str(mismatch) else f"{patch!r}: {mismatch}, expected {expected!r}"
    if expected:
        return f"additions takes {patch!r}, expected {expected!r}"
    good = {"slave_sim/gel.cpp": "int gel;\n", "slave_sim/list.hpp": "zero\none\ngel\nmore\n"}
    return None if files == good else f"{patch!r}: {files}"


def disagreement(check, path, text, expected):
    """What the check says wrongly about one file, or None."""
    findings = check.check({**HEADERS, path: text})
    if expected is None:
        return f"{check.__name__} refuses {text!r} in {path}: {findings}" if findings else None
    if len(findings) == 1 and path in findings[0] and expected in findings[0]:
        return None
    return f"{check.__name__} says {findings} about {text!r} in {path}, expected one with {expected!r}"


def report_disagreements():
    """The exit code is what ctest sees, so it is tested too: findings fail, and so does having looked at nothing."""
    with contextlib.redirect_stdout(io.StringIO()):
        codes = [report([], 3, "x"), report(["one"], 3, "x"), report([], 0, "x")]
    return [] if codes == [0, 1, 1] else [f"report() returns {codes}, expected [0, 1, 1]"]


def library_disagreements():
    words = "a.o:\n                 U exp\n                 U atanf\n                 U explain\n                 U sqrt\n                 U sincosf\n"
    taken = library_functions.names_taken(words)
    return [] if taken == ["exp", "sincosf"] else [f"names_taken() gives {taken}"]


if __name__ == "__main__":
    wrong = [d for case in CASES if (d := disagreement(*case))] + report_disagreements() + library_disagreements()
    wrong += [d for case in ADDITIONS if (d := addition_disagreement(*case))]
    sys.exit(report(wrong, len(CASES) + len(ADDITIONS), "self-test", of="cases"))
