// A cell with the virtual operator: experiment 3's trials with a compensator in the place of HF, or with CF, CCF, VF.
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "common/error.hpp"
#include "study/compensators/compensator_study.hpp"
#include "study/loop_limits.hpp"
#include "study/maps/cells.hpp"

namespace thimble {
namespace {

double handle_per_needle(const SystemSettings& s) { return s.master.position_scale * s.master.force_scale; }

// The fixture as stiff as the cell says, the force's link with its jitter and loss.
SystemSettings settings_of(const MapGrid& g, const CellPlace& place) {
    const SystemSettings plain = load_system_settings(g.config);
    const double at_needle_N_per_m = g.stiffness_N_per_m[place.stiffness] / handle_per_needle(plain);
    SystemSettings settings =
        load_system_settings(g.config, {{"fixture.stiffness_N_per_m", at_needle_N_per_m}});
    settings.netem = NetemSettings{};  // the cell says what the network does
    LinkSettings& link = settings.netem.force;
    const double jitter_s = g.jitters_s[place.jitter], loss = g.losses[place.loss];
    if (jitter_s > 0) {
        link.jitter = {JitterShape::kUniform, from_seconds(jitter_s / 2)};
        link.in_order = false;
    }
    if (loss > 0)
        link.loss =
            g.mean_burst > 1 ? LossSettings::gilbert(loss, g.mean_burst) : LossSettings::independent(loss);
    return settings;
}

char outcome_of(const CompensatorRow& row) {
    if (2 * row.oscillating > row.trials) return 'O';
    return row.oscillating == 0 && row.completed == row.trials ? 'S' : 'M';
}

std::string field(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : ""; }

// NaN where more than the delay makes the position older: nothing measures its age here.
double effective_delay_s(const MapGrid& g, const CellPlace& place, const SystemSettings& settings) {
    const bool plain = g.compensators[place.compensator] == kCompensatorNames[0] &&
                       g.jitters_s[place.jitter] == 0 && g.losses[place.loss] == 0 &&
                       !settings.slave.codec.used();
    if (!plain) return std::numeric_limits<double>::quiet_NaN();
    return g.delays_s[place.delay] + to_seconds(settings.master.sample_period) / 2;
}

}  // namespace

double virtual_critical_N_per_m(const MapGrid& g, const CellPlace& place) {
    const SystemSettings settings = load_system_settings(g.config);
    const HeldHandle held = held_handle(settings);
    const double loop_s = g.delays_s[place.delay] + to_seconds(settings.master.sample_period) / 2;
    const auto stable = [&](double stiffness) { return critical_delay_s(held, stiffness) > loop_s; };
    double low = 1e-3, high = low;
    while (high < 1e9 && stable(high)) {
        low = high;
        high *= 4;
    }
    for (int i = 0; i < 60; ++i) {
        const double middle = std::sqrt(low * high);
        (stable(middle) ? low : high) = middle;
    }
    return low;
}

std::string virtual_measures(const MapGrid& g, const CellPlace& place) {
    const SystemSettings settings = settings_of(g, place);
    CompensatorStudyOptions options;
    // Delays are drawn about their mean there, here from the least one up.
    const double delay_s = g.delays_s[place.delay] + g.jitters_s[place.jitter] / 2;
    options.networks = plain_networks({delay_s});
    const std::string& compensator = g.compensators[place.compensator];
    options.names = {compensator == kCompensatorNames[0] ? to_string(Modality::kHF) : compensator};
    options.subjects = g.trials;
    options.seed = g.seed;
    options.jobs = 1;
    const CompensatorRow row = run_compensator_study(settings, options).at(0);
    return fmt::format(",,{},,{},,,{},{},{},{},{},{},{},{}", outcome_of(row),
                       field(row.oscillation_peak_to_peak_m / settings.master.position_scale),
                       field(effective_delay_s(g, place, settings)), field(row.share), row.trials,
                       row.completed, row.oscillating, field(row.penetration_mean_m),
                       field(row.penetration_max_m), field(row.completion_time_s));
}

}  // namespace thimble
