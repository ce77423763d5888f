
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stability/critical_delay.hpp"
#include "study/fit/fit.hpp"
#include "study/loop_limits.hpp"

namespace thimble {
namespace {

constexpr int kHalvings = 6;

// A key's 90 % interval; a fit without one has its median at both ends.
std::array<double, 2> interval_of(const nlohmann::json& fit, const char* key, double median) {
    const auto end = [&](const char* name) {
        const auto at = nlohmann::json::json_pointer("/parameters") / key / name;
        return fit.is_object() && fit.contains(at) && fit[at].is_number() ? fit[at].get<double>() : median;
    };
    return {end("low"), end("high")};
}

// The twin's hand, then one for each combination of interval ends of arm and grip.
std::vector<HeldHandle> hands_of(SystemSettings twin, const std::filesystem::path& fit) {
    std::vector<HeldHandle> hands{held_handle(twin)};
    std::ifstream file(fit_file(fit));
    const auto json = nlohmann::json::parse(file, nullptr, false);
    HandMechanics& hand = twin.person.hand;
    const auto arms = interval_of(json, "operator.arm_stiffness_N_per_m", hand.arm_stiffness_N_per_m),
               grips = interval_of(json, "operator.grip_stiffness_N_per_m", hand.grip_stiffness_N_per_m);
    for (const double arm_N_per_m : arms) {
        for (const double grip_N_per_m : grips) {
            hand.arm_stiffness_N_per_m = arm_N_per_m;
            hand.grip_stiffness_N_per_m = grip_N_per_m;
            hands.push_back(held_handle(twin));
        }
    }
    return hands;
}

std::string in_milliseconds(double delay_s) {
    return std::isinf(delay_s) ? "any" : fmt::format("{:.2f}", 1000 * delay_s);
}

}  // namespace

std::vector<DelayBound> delay_bounds(const SystemSettings& settings, const std::filesystem::path& fit) {
    const std::vector<HeldHandle> hands = hands_of(settings, fit);
    double stiffness_N_per_m = settings.master.position_scale * settings.master.force_scale *
                               fixture_stiffness_N_per_m(settings.slave);
    std::vector<DelayBound> bounds;
    bounds.reserve(kHalvings + 1);
    for (int i = 0; i <= kHalvings && stiffness_N_per_m > 0; ++i, stiffness_N_per_m /= 2) {
        DelayBound bound{stiffness_N_per_m, critical_delay_s(hands.front(), stiffness_N_per_m),
                         std::numeric_limits<double>::infinity()};
        for (const HeldHandle& hand : hands)
            bound.least_s = std::min(bound.least_s, critical_delay_s(hand, stiffness_N_per_m));
        bounds.push_back(bound);
    }
    return bounds;
}

ReportTable bounds_table(const std::vector<DelayBound>& bounds) {
    ReportTable table{"Stable delay and stiffness for this person's hand (HF)",
                      "Greatest round-trip delay at which the loop is stable, by theory. The stiffnesses of "
                      "arm and grip come from the fit. Least: for the worst ends of their 90 % intervals. "
                      "Dry friction of the handle allows a little more. Co-contraction is left out.",
                      {"stiffness at the handle (N/m)", "delay at the medians (ms)", "least (ms)"}};
    for (const DelayBound& bound : bounds)
        table.rows.push_back({fmt::format("{:g}", bound.stiffness_N_per_m), in_milliseconds(bound.median_s),
                              in_milliseconds(bound.least_s)});
    return table;
}

}  // namespace thimble
