#include "master/velocity_settings.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace thimble {
namespace {

using std::chrono::seconds;

constexpr double kEncoderStep_hand_m = 1e-5;

struct Use {
    std::string_view key;
    std::vector<VelocityMethod> methods;
};

std::vector<Use> uses() {
    using M = VelocityMethod;
    return {{"velocity_time_constant_s", {M::kLowPass}},
            {"velocity_window_s", {M::kWindowed, M::kFoaw}},
            {"velocity_foaw_fit", {M::kFoaw}},
            {"velocity_quantum_needle_m", {M::kFoaw, M::kKalman}},
            {"velocity_process_noise_m2_per_s3", {M::kKalman}}};
}

std::string_view name_of(VelocityMethod method) {
    return kVelocityMethodNames[static_cast<std::size_t>(method)];
}

void refuse_without_effect(const ConfigTable& table, VelocityMethod chosen) {
    for (const Use& use : uses()) {
        const bool used = std::find(use.methods.begin(), use.methods.end(), chosen) != use.methods.end();
        if (used || !table.has(use.key)) continue;
        std::vector<std::string_view> names;
        for (const VelocityMethod method : use.methods) names.push_back(name_of(method));
        table.fail(use.key,
                   fmt::format("has no effect with velocity_estimator = \"{}\": remove it, or choose {}",
                               name_of(chosen), fmt::join(names, " or ")));
    }
}

// At least one sample, at most what there is room for.
Duration read_window(const ConfigTable& table, Duration fallback, Duration sample_period) {
    const Duration window =
        table.seconds("velocity_window_s", std::max(fallback, sample_period), sample_period, seconds{1});
    constexpr std::size_t kMost = SampleWindow::kCapacity - 1;
    if (window > static_cast<std::int64_t>(kMost) * sample_period) {
        table.fail("velocity_window_s",
                   fmt::format("must be at most {} times sample_period_s: no more samples are kept", kMost));
    }
    return window;
}

}  // namespace

VelocitySettings read_velocity_settings(const ConfigTable& table, Duration sample_period,
                                        double position_scale) {
    VelocitySettings v;
    v.sample_period = sample_period;
    v.method =
        static_cast<VelocityMethod>(table.choice("velocity_estimator", static_cast<std::size_t>(v.method),
                                                 {kVelocityMethodNames.begin(), kVelocityMethodNames.end()}));
    refuse_without_effect(table, v.method);
    v.time_constant = table.seconds("velocity_time_constant_s", v.time_constant, Duration{0}, seconds{1});
    v.window = read_window(table, v.window, sample_period);
    v.fit = table.choice("velocity_foaw_fit", 0, {"best", "end"}) == 0 ? FoawFit::kBest : FoawFit::kEnd;
    v.quantum_m = table.number("velocity_quantum_needle_m", position_scale * kEncoderStep_hand_m, 1e-9, 0.1);
    v.acceleration_noise_m2_per_s3 =
        table.number("velocity_process_noise_m2_per_s3", v.acceleration_noise_m2_per_s3, 1e-9, 1e6);
    return v;
}

}  // namespace thimble
