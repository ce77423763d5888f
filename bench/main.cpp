// thimble-bench: how fast the parts are (Google Benchmark), and studies that weigh speed against error.
#include <array>
#include <string_view>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "bench/studies.hpp"
#include "common/error.hpp"
#include "common/runtime/node_program.hpp"

namespace {

using namespace thimble;

struct Study {
    std::string_view name;
    std::string_view about;
    int (*run)(int argc, char** argv);
};

constexpr std::array<Study, 5> kStudies{{
    {"codecs", "haptic codecs: packets saved against penetration", &codec_study},
    {"netem", "the relay beside the bare machine: lateness, throughput, round trip", &network_study},
    {"ends", "sender and receiver of a path between namespaces: errors of its delay", &network_ends},
    {"stability", "the delayed force loop: theory beside the running loop", &stability_study},
    {"work-precision", "tissue solvers: cost against error", &work_precision_study},
}};

void say_help() {
    fmt::print("thimble-bench [--benchmark_filter=REGEX ...]  how fast the parts are (Google Benchmark)\n");
    for (const Study& study : kStudies) {
        fmt::print("thimble-bench {:<16}[--help ...]     {}\n", study.name, study.about);
    }
}

int run_benchmarks(int argc, char** argv) {
    benchmark::Initialize(&argc, argv, &say_help);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return static_cast<int>(ExitCode::kUsage);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}

int run(int argc, char** argv) {
    for (const Study& study : kStudies) {
        if (argc > 1 && study.name == argv[1]) return study.run(argc - 1, argv + 1);
    }
    return run_benchmarks(argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main("thimble-bench", [&] { return run(argc, argv); });
}
