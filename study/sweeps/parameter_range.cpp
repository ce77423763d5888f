#include "study/sweeps/parameter_range.hpp"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "common/duration_text.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

[[noreturn]] void refuse_range(std::string_view text, const std::string& why) {
    throw Error(
        ExitCode::kUsage,
        fmt::format(
            "--vary {}: {}; write NAME=LOW:HIGH or NAME=LOW:HIGH:POINTS, e.g. handle.friction_N=0.3:1:8",
            text, why));
}

}  // namespace

double ParameterRange::at(unsigned point) const {
    return low + (high - low) * static_cast<double>(point) / static_cast<double>(points - 1);
}

double ParameterRange::within(double share) const { return low + (high - low) * share; }

void ParameterRange::set(std::vector<SettingChange>& changes, double value) const {
    for (const std::string& key : keys) changes.push_back({key, value});
}

ParameterRange parse_parameter_range(std::string_view text) {
    std::string_view rest = text;
    ParameterRange range;
    range.keys = {std::string(take_until(rest, '='))};
    if (range.name().find('.') == std::string::npos)
        refuse_range(text, "write the name with its table, e.g. operator.criterion_N");
    if (range.name() == "netem.force.delay_s")
        refuse_range(text, "each experiment sets this delay itself: vary another parameter");
    for (const ParameterRange& known : documented_ranges()) {
        if (known.name() == range.name()) range.keys = known.keys;
    }
    const std::string name = range.name().substr(range.name().rfind('.') + 1);
    const auto end_of = [&](std::string_view word) {
        const auto plain = parse_number(word);
        const std::string why = plain ? doubt_seconds(name, *plain) : "";
        if (!why.empty()) refuse_range(text, why);
        return plain || !holds_seconds(range.name()) ? plain : parse_duration(word);
    };
    const auto low = end_of(take_until(rest, ':')), high = end_of(take_until(rest, ':'));
    if (!low || !high) refuse_range(text, "both ends must be numbers");
    if (*low >= *high) refuse_range(text, "the low end must lie below the high end");
    range.low = *low;
    range.high = *high;
    if (rest.empty()) return range;
    const auto points = parse_whole<unsigned>(rest);
    if (!points || *points < 2 || *points > 1000)
        refuse_range(text, "the number of points must be 2 to 1000");
    range.points = *points;
    return range;
}

const std::vector<ParameterRange>& documented_ranges() {
    static const std::vector<ParameterRange> ranges{
        {{"handle.moving_mass_kg"}, 0.15, 0.40},
        // Up to 1 N: with more, no handle oscillates at 50 ms, which the paper's did.
        {{"handle.friction_N"}, 0, 1},
        {{"handle.force_limit_N", "operator.full_scale_handle_N"}, 8, 12},
        {{"cutaneous.force_limit_N", "operator.full_scale_cutaneous_N"}, 1.5, 5},
        {{"visual.pipeline_s"}, 0.010, 0.040},
        {{"operator.arm_stiffness_N_per_m"}, 200, 600},
        {{"operator.arm_mass_kg"}, 0.6, 2},
        {{"operator.arm_damping_ratio"}, 0.25, 0.70},
        {{"operator.grip_stiffness_N_per_m"}, 500, 2500},
        {{"operator.grip_damping_ratio"}, 0.3, 1},
        {{"operator.cocontraction"}, 0, 0.5},
        {{"operator.cocontraction_limit"}, 1, 3},
        {{"operator.speed_insert_needle_m_per_s"}, 0.010, 0.040},
        {{"operator.spread_speed"}, 0.10, 0.35},
        {{"operator.speed_trial_variation"}, 0.05, 0.20},
        {{"operator.criterion_N"}, 1, 4},
        {{"operator.reaction_handle_s"}, 0.070, 0.160},
        {{"operator.reaction_cutaneous_s"}, 0.095, 0.155},
        {{"operator.reaction_tactile_s"}, 0.140, 0.170},
        {{"operator.reaction_crossing_s"}, 0.001, 0.006},
        {{"operator.reaction_compatibility_s"}, 0, 0.040},
        {{"operator.reaction_visual_s"}, 0.189, 0.290},
        {{"operator.reaction_auditory_s"}, 0.140, 0.170},
        {{"operator.spread_reaction"}, 0.08, 0.15},
        {{"operator.spread_reaction_modality"}, 0.03, 0.10},
        {{"operator.reaction_trial_variation"}, 0.10, 0.25},
        {{"operator.brake_s"}, 0.080, 0.250},
        {{"operator.sway_m"}, 0.0001, 0.0010},
        {{"operator.relax_s"}, 0.1, 0.5},
        {{"operator.slowing"}, 0.4, 0.8},
        {{"operator.slowest"}, 0.05, 0.3},
    };
    return ranges;
}

}  // namespace thimble
