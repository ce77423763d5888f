// The delayed force loop: predictions of the theory and measurements, for each hand, and the time of both.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/studies.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/wall_clock.hpp"
#include "stability/critical_delay.hpp"
#include "stability/loop_measures.hpp"

namespace thimble {
namespace {

constexpr std::array<double, 9> kStudiedDelays_s{0, 0.001, 0.002, 0.005, 0.010, 0.025, 0.050, 0.100, 0.200};
constexpr double kStep_s = 1e-3;

class Stopwatch {
  public:
    double seconds() const { return to_seconds(wall_now() - start_); }

  private:
    SessionTime start_ = wall_now();
};

void print_hand_table() {
    constexpr double kLoop = 9000;
    const Stopwatch closed;
    std::string line;
    for (const double m : {0.1, 0.35, 1.0, 2.0}) {
        line += fmt::format("| {} |", m);
        for (const double b : {2.0, 5.0, 10.0, 20.0, 40.0}) {
            line += fmt::format(" {:.4g} |", 1e3 * critical_delay_s(HeldMass{m, b, 300}, kLoop));
        }
        line += '\n';
    }
    const double closed_s = closed.seconds();
    fmt::print(
        "Critical delay in ms, k = 300 N/m, K = 9000 N/m, closed form ({:.2g} s)\n\n| m \\ b | 2 | 5 | 10 | "
        "20 | 40 |\n"
        "|---|---|---|---|---|---|\n{}\n",
        closed_s, line);
    const Stopwatch running;
    double worst_s = 0;
    for (const double m : {0.1, 0.35, 1.0, 2.0}) {
        for (const double b : {2.0, 5.0, 10.0, 20.0, 40.0}) {
            const HeldMass hand{m, b, 300};
            const double measured_s = measured_critical_delay_s(hand, kLoop);
            worst_s = std::max(worst_s, std::abs(measured_s - critical_delay_s(hand, kLoop)));
        }
    }
    fmt::print(
        "The same by bisection of the running loop at 10 kHz, plus half a step: at most {:.2g} us off; "
        "{:.2g} s\n\n",
        1e6 * worst_s, running.seconds());
}

void print_measured() {
    fmt::print("Critical stiffness in N/m at 1 kHz, theory of the sampled loop\n\n| hand |");
    for (const double delay_s : kStudiedDelays_s) fmt::print(" {:g} ms |", 1e3 * delay_s);
    fmt::print("\n|---|");
    for (std::size_t i = 0; i < kStudiedDelays_s.size(); ++i) fmt::print("---|");
    fmt::print("\n");
    const Stopwatch watch;
    int runs = 0;
    double worst = 0, worst_with_encoder = 0;
    for (const auto& [name, hand] : kTypicalHands) {
        fmt::print("| {} |", name);
        for (const double delay_s : kStudiedDelays_s) {
            const SampledLoop loop{hand, 1, delay_s, kStep_s};
            const double theory = critical_sampled_stiffness(loop).stiffness_N_per_m;
            const MeasuredStiffness exact = measured_critical_stiffness(loop, 0, 1e-8);
            const MeasuredStiffness coarse = measured_critical_stiffness(loop, 1e-5, 1e-5);
            runs += exact.runs + coarse.runs;
            worst = std::max(worst, std::abs(exact.stiffness_N_per_m / theory - 1));
            worst_with_encoder =
                std::max(worst_with_encoder, std::abs(coarse.stiffness_N_per_m / theory - 1));
            fmt::print(" {:.5g} |", theory);
        }
        fmt::print("\n");
    }
    fmt::print(
        "\nMeasured on the running loop: at most {:.2g} off, with an encoder of 10 um {:.2g} %; {} runs in "
        "{:.2g} s\n",
        worst, 100 * worst_with_encoder, runs, watch.seconds());
}

}  // namespace

int stability_study(int argc, char** argv) {
    CLI::App app("Critical delays and stiffnesses: closed form beside the running loop. Prints Markdown.",
                 "thimble-bench stability");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    print_hand_table();
    print_measured();
    return 0;
}

}  // namespace thimble
