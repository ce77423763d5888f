// The parts of a simulated millisecond: tissue, link, handle with its hand.
//   build/release/bin/thimble-bench --benchmark_filter=part
#include <array>
#include <cmath>
#include <numbers>

#include <benchmark/benchmark.h>

#include "master/devices/simulated_handle.hpp"
#include "netem/link_model.hpp"
#include "slave_sim/slave_node.hpp"

namespace {

using namespace thimble;

constexpr Duration kTick = std::chrono::milliseconds{1};

// A needle that goes in and out of the tissue at up to 80 mm/s.
void part_slave_node(benchmark::State& state) {
    SlaveNode node{SlaveSettings{}};
    SessionControl start;
    start.fixture_position_m = 0.123;
    node.start_trial(start);
    std::array<NeedleCommand, 4096> commands{};
    for (std::size_t i = 0; i < commands.size(); ++i) {
        const double phase =
            2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(commands.size());
        commands[i].position_needle_m = commands[i].position_needle_estimate_m =
            0.05 - 0.05 * std::cos(phase);
    }
    SessionTime now{};
    std::uint32_t sequence = 0;
    for (auto _ : state) {
        now += kTick;
        ++sequence;
        benchmark::DoNotOptimize(node.on_needle(now, sequence, commands[sequence % commands.size()]));
    }
}
BENCHMARK(part_slave_node);

void part_link(benchmark::State& state) {
    LinkSettings settings;
    settings.delay = std::chrono::milliseconds{state.range(0)};
    LinkModel link(settings, {}, 1);
    std::array<std::uint8_t, 144> datagram{};
    SessionTime now{};
    for (auto _ : state) {
        now += kTick;
        link.push(now, datagram);
        benchmark::DoNotOptimize(link.pop_due(now).data());
    }
}
BENCHMARK(part_link)->ArgName("delay_ms")->Arg(0)->Arg(50);

void part_handle(benchmark::State& state) {
    SimulatedHandle handle{HandleSettings{}, OperatorParameters{}};
    SessionTime now{};
    handle.start_trial(now, {1, 3, 1, 1, Modality::kHF});
    for (auto _ : state) {
        now += kTick;
        benchmark::DoNotOptimize(handle.read(now));
        handle.command_force(now, 0);
    }
}
BENCHMARK(part_handle);

}  // namespace
