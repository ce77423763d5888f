#include "study/maps/map_options.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "common/error.hpp"
#include "common/runtime/command_line.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {
namespace {

// The help shows the default.
template <class Value>
CLI::Option& add(CLI::App& command, const char* name, Value& value, const char* help) {
    return *command.add_option(name, value, help)->capture_default_str();
}

void add_loop_options(CLI::App& command, SweepArguments& a) {
    add(command, "--hand", a.hands,
        "models of hand and handle, separated by commas: A light pinch, B pinch, C arm, D firm grip, E power "
        "grip")
        .delimiter(',');
    CLI::Option* mass =
        command.add_option("--mass-kg", a.own_hand.mass_kg,
                           "your own hand instead of --hand: mass of hand and handle together, kg");
    CLI::Option* damping =
        command
            .add_option("--damping-Ns-per-m", a.own_hand.damping_Ns_per_m, "damping of hand and handle, Ns/m")
            ->needs(mass);
    CLI::Option* stiffness =
        command.add_option("--stiffness-N-per-m", a.own_hand.stiffness_N_per_m, "stiffness of the hand, N/m")
            ->needs(mass);
    mass->needs(damping)->needs(stiffness)->excludes("--hand");
    command
        .add_option(
            "--delay-s", a.delays,
            "round-trip delays, s: evenly spaced, or a list like 0,0.05 (default: the session's, else "
            "0:0.2:41)")
        ->type_name("LOW:HIGH:POINTS");
    CLI::Option* contact =
        command
            .add_option("--contact-stiffness-N-per-m", a.stiffness,
                        "stiffnesses of the fixture at the handle, N/m: evenly spaced in the logarithm, or a "
                        "list (default: 50:20000:41)")
            ->type_name("LOW:HIGH:POINTS");
    command
        .add_option("--gain", a.gain,
                    "gains of the force, instead of stiffnesses: evenly spaced in the logarithm, or a list. "
                    "A gain of 1 "
                    "means --full-stiffness-N-per-m")
        ->type_name("LOW:HIGH:POINTS")
        ->excludes(contact);
    add(command, "--full-stiffness-N-per-m", a.rest.full_stiffness_N_per_m,
        "stiffness at the handle for a gain of 1, N/m")
        .check(CLI::PositiveNumber);
    command
        .add_option("--compensators", a.compensators,
                    "delay compensators, separated by commas: none (default), scaled, passivity, "
                    "energy-bound, energy-bound-memoryless, two-layer, "
                    "local-fixture, wave, two-port, adaptive-fixture, predicted-share, four-channel "
                    "(docs/compensators.md), or plugin, which the session names")
        ->delimiter(',');
}

void add_network_options(CLI::App& command, SweepArguments& a) {
    add(command, "--jitter-s", a.jitters,
        "jitter, s: a list, or LOW:HIGH:POINTS. Each packet arrives later by 0 to this much, so packets can "
        "overtake each other");
    add(command, "--loss", a.losses, "share of packets that are lost, 0 to 0.5: a list, or LOW:HIGH:POINTS");
    add(command, "--loss-burst", a.rest.mean_burst,
        "mean number of packets lost in a row; 1: independent losses")
        .check(CLI::Range(1.0, 1e6));
    command.add_option("-s,--seed", a.seed,
                       "seed of delays, losses and virtual subjects (default: [session] seed, else 1)");
}

void add_hold_options(CLI::App& command, SweepArguments& a) {
    add(command, "--step-s", a.rest.step_s, "sampling period, s").check(CLI::Range(1e-5, 0.1));
    add(command, "--press-N", a.rest.press_N, "force with which the hand presses on the fixture, N");
    add(command, "--force-limit-N", a.rest.force_limit_N, "force limit of the handle, N")
        .check(CLI::PositiveNumber);
    add(command, "--encoder-m", a.rest.encoder_step_m, "resolution of the handle's encoder, m")
        .check(CLI::NonNegativeNumber);
    add(command, "--friction-N", a.rest.friction_N, "dry friction of the handle, N")
        .check(CLI::NonNegativeNumber);
}

void add_operator_options(CLI::App& command, SweepArguments& a) {
    add(command, "--operator", a.who,
        "passive: a hand that presses on the fixture; virtual: trials of experiment 3 with virtual subjects, "
        "who have hands of their own. With virtual, --compensators may also be CF, CCF and VF")
        .check(CLI::IsMember({"passive", "virtual"}));
    add(command, "--trials", a.rest.trials,
        "trials in each cell with --operator virtual, each with another subject")
        .check(CLI::Range(1, 10000));
    command.add_option(
        "session", a.session,
        "session: a TOML file, or one that comes with the program. With --operator virtual it gives the "
        "operator, and the delays and modalities unless --delay-s and --compensators are given. With "
        "--compensators plugin it names the plug-in");
}

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

void add_sweep_options(CLI::App& command, SweepArguments& a) {
    add_loop_options(command, a);
    add_network_options(command, a);
    add_hold_options(command, a);
    add_operator_options(command, a);
    command.add_option("-o,--out", a.out, "folder for map.csv, map.svg and map.txt")
        ->default_val("out/map")
        ->type_name("FOLDER");
    add_jobs_option(command, a.jobs);
    command
        .add_option("--block", a.block,
                    "cells that a thread takes at a time; 0 (default): chosen by the number of cells")
        ->check(CLI::Range(0, 1000000));
    add_resume_options(command, a.if_exists, "map");
    command.footer(
        "Examples:\n  thimble sweep --hand D --out out/map\n"
        "  thimble sweep --hand A,D --compensators none,wave,energy-bound --jitter-s 0,0.005 --loss 0,0.05 "
        "--out out/compensators\n"
        "  thimble sweep my-session.toml --operator virtual --gain 0.1:1:4 --trials 3 --out out/people\n"
        "  mpirun -n 4 thimble sweep --hand A,B,C,D,E --out out/hands\n"
        "Manual, with the classes of the map: docs/stability.md");
}

MapGrid grid_of(const SweepArguments& a) {
    MapGrid grid = a.rest;
    const bool person = a.who == "virtual";
    grid.who = person ? MapOperator::kVirtual : MapOperator::kPassive;
    if (person && (a.own_hand.mass_kg > 0 || a.hands != std::vector<std::string>{"D"}))
        throw Error(
            ExitCode::kUsage,
            "--operator virtual uses the hand of the session's [operator]: leave out --hand and --mass-kg");
    if (!person && !a.session.empty()) {
        if (std::find(a.compensators.begin(), a.compensators.end(), "plugin") == a.compensators.end())
            throw Error(ExitCode::kUsage,
                        "thimble sweep uses a session only with --operator virtual or --compensators "
                        "plugin: add one of them, or leave the session out");
        grid.config = find_session_file(a.session).string();
    }
    if (person) {
        grid.hands = {{"virtual", {1, 0, 0}}};
    } else if (a.own_hand.mass_kg != 0) {
        grid.hands = {{"own", a.own_hand}};
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
