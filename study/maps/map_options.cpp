#include "study/maps/map_options.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {
namespace {

// The virtual operator has the session's trials, but for their number, which is --trials.
void take_session(const SweepArguments& a, MapGrid& grid) {
    if (!a.session.empty()) grid.config = find_session_file(a.session).string();
    const SystemSettings settings = load_system_settings(grid.config);
    require_virtual_subjects(settings, "sweep");
    if (settings.protocol)
        throw Error(ExitCode::kUsage,
                    "[protocol] sets the number of trials of each subject, but thimble sweep runs --trials "
                    "trials in each cell, each with another subject: leave [protocol] out");
    grid.seed = a.seed.value_or(settings.plan.seed);
    if (a.delays.empty() && settings.plan.names_delays) {
        grid.delays_s.clear();
        for (const Duration delay : settings.plan.delays) grid.delays_s.push_back(to_seconds(delay));
    }
    if (!a.compensators.empty() || !settings.plan.names_modalities) return;
    grid.compensators.clear();
    for (const Modality modality : settings.plan.modalities)
        grid.compensators.emplace_back(modality == Modality::kHF ? "none" : to_string(modality));
}

}  // namespace

MapGrid grid_of(const SweepArguments& a) {
    MapGrid grid = a.rest;
    const bool person = a.who == "virtual";
    grid.who = person ? MapOperator::kVirtual : MapOperator::kPassive;
    if (person && (a.own_mass_kg || a.hands != std::vector<std::string>{"D"}))
        throw Error(
            ExitCode::kUsage,
            "--operator virtual uses the hand of the session's [operator]: leave out --hand and --mass-kg");
    if (!person && !a.session.empty()) {
        if (std::find(a.compensators.begin(), a.compensators.end(), "plugin") == a.compensators.end())
            throw Error(ExitCode::kUsage,
                        "thimble sweep uses a session only with --operator virtual or --compensators "
                        "plugin: add one of them, or leave the session out");
        grid.config = find_session_file(a.session).string();
        grid.seed = load_system_settings(grid.config).plan.seed;
    }
    if (person) {
        grid.hands = {{"virtual", {1, 0, 0}}};
    } else if (a.own_mass_kg) {
        grid.hands = {{"own", {*a.own_mass_kg, a.own_hand.damping_Ns_per_m, a.own_hand.stiffness_N_per_m}}};
    } else {
        for (const std::string& letter : a.hands) grid.hands.push_back(named_hand(letter));
    }
    grid.seed = a.seed.value_or(grid.seed);
    grid.compensators = a.compensators.empty() ? std::vector<std::string>{"none"} : a.compensators;
    grid.delays_s = parse_map_axis("--delay-s", a.delays.empty() ? "0:0.2:41" : a.delays, false);
    if (person) take_session(a, grid);
    grid.jitters_s = parse_map_axis("--jitter-s", a.jitters, false);
    grid.losses = parse_map_axis("--loss", a.losses, false);
    if (!a.gain.empty()) {
        grid.stiffness_N_per_m = parse_map_axis("--gain", a.gain, true);
        for (double& value : grid.stiffness_N_per_m) value *= grid.full_stiffness_N_per_m;
    } else {
        grid.stiffness_N_per_m = parse_map_axis("--contact-stiffness-N-per-m",
                                                a.stiffness.empty() ? "50:20000:41" : a.stiffness, true);
    }
    require_meaningful(grid);
    return grid;
}

}  // namespace thimble
