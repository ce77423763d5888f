#include "study/maps/map_options.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "common/error.hpp"
#include "session/settings/session_files.hpp"
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
        "named hands, several with commas: A light pinch, B pinch, C arm, D firm grip, E power grip")
        .delimiter(',');
    CLI::Option* mass = command.add_option("--mass-kg", a.own_hand.mass_kg,
                                           "instead of --hand: hand and handle, moved together");
    CLI::Option* damping =
        command.add_option("--damping-Ns-per-m", a.own_hand.damping_Ns_per_m, "of hand and handle")
            ->needs(mass);
    CLI::Option* stiffness =
        command.add_option("--stiffness-N-per-m", a.own_hand.stiffness_N_per_m, "of the hand")->needs(mass);
    mass->needs(damping)->needs(stiffness)->excludes("--hand");
    command
        .add_option("--delay-s", a.delays,
                    "of the whole way round: evenly spread, or values like 0,0.05; without it the session's, "
                    "else 0:0.2:41")
        ->type_name("LOW:HIGH:POINTS");
    CLI::Option* contact =
        command
            .add_option("--contact-stiffness-N-per-m", a.stiffness,
                        "of the fixture at the handle, evenly in its logarithm (50:20000:41), or values")
            ->type_name("LOW:HIGH:POINTS");
    command
        .add_option(
            "--gain", a.gain,
            "instead: of the force, evenly in its logarithm, or values; 1 is --full-stiffness-N-per-m")
        ->type_name("LOW:HIGH:POINTS")
        ->excludes(contact);
    add(command, "--full-stiffness-N-per-m", a.rest.full_stiffness_N_per_m, "of a gain of 1, at the handle")
        .check(CLI::PositiveNumber);
    command
        .add_option("--compensator", a.compensators,
                    "none (default), scaled, passivity, energy-bound, energy-bound-memoryless, two-layer, "
                    "local-fixture, wave, two-port, adaptive-fixture, predicted-share, four-channel "
                    "(docs/compensators.md), or the session's plugin, several with commas")
        ->delimiter(',');
}

void add_network_options(CLI::App& command, SweepArguments& a) {
    add(command, "--jitter-s", a.jitters, "each packet is late by 0 to this, so they overtake");
    add(command, "--loss", a.losses, "share of packets that is lost");
    add(command, "--loss-burst", a.rest.mean_burst, "packets lost in a row on average; 1: each by itself")
        .check(CLI::Range(1.0, 1e6));
    command.add_option("--seed", a.seed,
                       "of delays, losses and virtual subjects, instead of [session] seed (1)");
}

void add_hold_options(CLI::App& command, SweepArguments& a) {
    add(command, "--step-s", a.rest.step_s, "between two samples").check(CLI::Range(1e-5, 0.1));
    add(command, "--press-N", a.rest.press_N, "with which the hand would press at the wall");
    add(command, "--force-limit-N", a.rest.force_limit_N, "of the handle").check(CLI::PositiveNumber);
    add(command, "--encoder-m", a.rest.encoder_step_m, "one step of the encoder")
        .check(CLI::NonNegativeNumber);
    add(command, "--friction-N", a.rest.friction_N, "dry friction of the handle")
        .check(CLI::NonNegativeNumber);
}

void add_operator_options(CLI::App& command, SweepArguments& a) {
    add(command, "--operator", a.who,
        "passive: a held hand presses; virtual: trials of experiment 3 by virtual subjects, who "
        "have hands of their own; --compensator may be CF, CCF, VF too")
        .check(CLI::IsMember({"passive", "virtual"}));
    add(command, "--trials", a.rest.trials, "of the virtual operator in each cell, each another subject")
        .check(CLI::Range(1, 10000));
    command.add_option(
        "session", a.session,
        "session file (TOML) or name, for the virtual operator: also its delays and modalities, "
        "unless --delay-s and --compensator are given; or the one with the plug-in of --compensator plugin");
}

// The virtual operator has the session's trials, but for their number, which is --trials.
void take_session(const SweepArguments& a, MapGrid& grid) {
    if (!a.session.empty()) grid.config = find_session_file(a.session).string();
    const SystemSettings settings = load_system_settings(grid.config);
    require_virtual_subjects(settings, "sweep");
    if (settings.protocol)
        throw Error(ExitCode::kUsage,
                    "[protocol] says how many trials each subject does, and thimble sweep runs --trials "
                    "trials in each cell, each of another subject: leave [protocol] out");
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
    command.add_option("-o,--out", a.out, "folder for map.csv, map.svg and map.txt")->default_val("out/map");
    command
        .add_option("-j,--jobs", a.jobs,
                    "threads, 0: one per core, or one for each rank; the results do not depend on it")
        ->check(CLI::Range(0, 1024));
    command.add_option("--block", a.block, "cells that a thread takes at a time, 0: by their number")
        ->check(CLI::Range(0, 1000000));
    CLI::Option* overwrite =
        command.add_flag("--overwrite", a.overwrite, "replace an earlier map in that folder");
    command
        .add_flag("--resume", a.resume,
                  "go on where an interrupted sweep of the same map ended; the same bytes come out")
        ->excludes(overwrite);
    command.footer(
        "Examples:\n  thimble sweep --hand D --out out/map\n"
        "  thimble sweep --hand A,D --compensator none,wave,energy-bound --jitter-s 0,0.005 --loss 0,0.05 "
        "--out out/compensators\n"
        "  thimble sweep my-session.toml --operator virtual --gain 0.1:1:4 --trials 3 --out out/people\n"
        "  mpirun -n 4 thimble sweep --hand A,B,C,D,E --out out/hands\n"
        "What the classes mean, and why peak-to-peak alone is not one: docs/stability.md");
}

MapGrid grid_of(const SweepArguments& a) {
    MapGrid grid = a.rest;
    const bool person = a.who == "virtual";
    grid.who = person ? MapOperator::kVirtual : MapOperator::kPassive;
    if (person && (a.own_hand.mass_kg > 0 || a.hands != std::vector<std::string>{"D"}))
        throw Error(ExitCode::kUsage,
                    "--operator virtual has a hand of its own ([operator] of the session): leave out --hand, "
                    "--mass-kg");
    if (!person && !a.session.empty()) {
        if (std::find(a.compensators.begin(), a.compensators.end(), "plugin") == a.compensators.end())
            throw Error(ExitCode::kUsage,
                        "a session is of --operator virtual, or names the plug-in of --compensator plugin: "
                        "say that, or leave it out");
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
