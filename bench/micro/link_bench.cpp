// The cost of each stage of a link: a packet of 144 bytes each millisecond, in and out again.
//   build/release/bin/thimble-bench --benchmark_filter=link_stage
#include <array>
#include <functional>

#include <benchmark/benchmark.h>

#include "common/math/portable.hpp"
#include "netem/delivery_trace.hpp"
#include "netem/jitter_table.hpp"
#include "netem/link_model.hpp"
#include "netem/packet_trace.hpp"

namespace {

using namespace thimble;
using std::chrono::milliseconds;

struct Stage {
    const char* name;
    std::function<void(LinkSettings&)> add;
};

std::function<void(LinkSettings&)> jitter(JitterShape shape, double correlation = 0) {
    return [=](LinkSettings& link) {
        link.jitter.shape = shape;
        link.jitter.spread = milliseconds{5};
        link.jitter.correlation = correlation;
    };
}

LossSettings four_state() {
    LossSettings loss;
    loss.shape = LossShape::kFourState;
    loss.p13 = 0.01;
    loss.p31 = 0.2;
    loss.p32 = 0.2;
    loss.p23 = 0.3;
    loss.p14 = 0.005;
    return loss;
}

JitterTable exponential() {
    std::vector<double> deviates;
    deviates.reserve(4096);
    for (int i = 0; i < 4096; ++i) deviates.push_back(-1 - portable::log1p(-(i + 0.5) / 4096));
    return JitterTable(deviates);
}

PacketTrace minute_of_delays() {
    std::vector<TraceRow> rows;
    rows.reserve(60'000);
    for (int i = 0; i < 60'000; ++i)
        rows.push_back({.at = std::int64_t{i} * 1'000'000, .delay = milliseconds{40 + i % 20}});
    return {rows, {.between = TraceBetween::kLinear}};
}

const std::vector<Stage>& stages() {
    static const std::vector<Stage> all{
        {"none", [](LinkSettings&) {}},
        {"jitter_uniform", jitter(JitterShape::kUniform)},
        {"jitter_normal", jitter(JitterShape::kNormal)},
        {"jitter_gamma", jitter(JitterShape::kGamma)},
        {"jitter_pareto", jitter(JitterShape::kPareto)},
        {"jitter_pareto_normal", jitter(JitterShape::kParetoNormal)},
        {"jitter_table",
         [](LinkSettings& link) {
             jitter(JitterShape::kTable)(link);
             link.jitter.table = std::make_shared<JitterTable>(exponential());
         }},
        {"jitter_normal_correlated", jitter(JitterShape::kNormal, 0.5)},
        {"jitter_pareto_correlated", jitter(JitterShape::kPareto, 0.5)},
        {"jitter_normal_unordered",
         [](LinkSettings& link) {
             jitter(JitterShape::kNormal)(link);
             link.in_order = false;
         }},
        {"loss_independent", [](LinkSettings& link) { link.loss = LossSettings::independent(0.01); }},
        {"loss_gilbert", [](LinkSettings& link) { link.loss = LossSettings::gilbert(0.01, 3); }},
        {"loss_four_state", [](LinkSettings& link) { link.loss = four_state(); }},
        {"duplicate", [](LinkSettings& link) { link.duplicate = 0.01; }},
        {"corrupt", [](LinkSettings& link) { link.corrupt = 0.01; }},
        {"reorder",
         [](LinkSettings& link) {
             link.reorder = 0.01;
             link.in_order = false;
         }},
        {"outage",
         [](LinkSettings& link) {
             link.outages = {
                 {.start = milliseconds{15'000}, .length = milliseconds{140}, .every = milliseconds{15'000}}};
         }},
        {"rate", [](LinkSettings& link) { link.rate.bits_per_s = 10e6; }},
        {"slots",
         [](LinkSettings& link) {
             link.slot = {.least = milliseconds{1}, .most = milliseconds{10}, .packets = 42};
         }},
        {"deliveries",
         [](LinkSettings& link) {
             link.deliveries = std::make_shared<DeliveryTrace>(std::vector<std::uint32_t>{1, 3, 4, 8, 10});
         }},
        {"trace", [](LinkSettings& link) { link.trace = std::make_shared<PacketTrace>(minute_of_delays()); }},
    };
    return all;
}

void link_stage(benchmark::State& state) {
    const Stage& stage = stages()[static_cast<std::size_t>(state.range(0))];
    LinkSettings settings;
    settings.delay = milliseconds{50};
    stage.add(settings);
    LinkModel link(settings, {}, 1);
    const std::array<std::uint8_t, 144> datagram{};
    SessionTime now{};
    for (auto _ : state) {
        now += milliseconds{1};
        link.push(now, datagram);
        while (link.next_due() <= now) benchmark::DoNotOptimize(link.pop_due(now).data());
    }
    state.SetLabel(stage.name);
}
BENCHMARK(link_stage)->ArgName("stage")->DenseRange(0, 20);

}  // namespace
