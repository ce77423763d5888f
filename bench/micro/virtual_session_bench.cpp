// The whole loop in virtual time, codec included: whole trials, per modality and delay. CPU time of one
// thread, so that neighbours on a shared machine count less.
//   build/release/bin/thimble-bench --benchmark_filter=virtual_trial
#include <benchmark/benchmark.h>

#include "session/settings/protocol.hpp"
#include "session/virtual/virtual_session.hpp"

namespace {

using namespace thimble;

void virtual_trial(benchmark::State& state) {
    const SystemSettings settings = load_system_settings("");
    TrialConditions conditions;
    conditions.study_seed = 1;
    conditions.fixture_position_m = settings.slave.fixture_position_m();
    conditions.modality = static_cast<Modality>(state.range(0));
    conditions.delay_s = static_cast<double>(state.range(1)) * 1e-3;
    double simulated_s = 0;
    for (auto _ : state) {
        const TrialRecord record = run_virtual_trial(settings, conditions);
        simulated_s += record.samples.back().time_s;
    }
    state.SetLabel(to_string(conditions.modality));
    // Counters of kind rate are divided by CPU time.
    state.counters["x_real_time"] = benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
    state.counters["s_per_tick"] =
        benchmark::Counter(simulated_s * 1000, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(virtual_trial)
    ->ArgNames({"modality", "delay_ms"})
    ->ArgsProduct({{0, 1, 2, 3}, {0, 50}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
