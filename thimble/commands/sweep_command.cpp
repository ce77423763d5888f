// thimble sweep: a stability map measured in virtual time, with the boundary of the theory.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "common/error.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/maps/map_options.hpp"
#include "study/ranks/ranks.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

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
    CLI::Option* mass = command.add_option(
        "--mass-kg", a.own_mass_kg, "your own hand instead of --hand: mass of hand and handle together, kg");
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
    as_session_seed(
        command.add_option("-s,--seed", a.seed,
                           "seed of delays, losses and virtual subjects (default: [session] seed, else 1)"));
}

void add_hold_options(CLI::App& command, SweepArguments& a) {
    add(command, "--step-s", a.rest.step_s, "sampling period, s").check(CLI::Range(1e-5, 0.1));
    add(command, "--press-N", a.rest.press_N, "force with which the hand presses on the fixture, N")
        .check(CLI::NonNegativeNumber);
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

// The virtual operator's session says how it holds which handle.
void refuse_unused(const CLI::App& command, const std::string& who) {
    const auto refuse = [&](const char* option) {
        if (command.get_option(option)->count() > 0)
            throw Error(ExitCode::kUsage, "{} is not used by --operator {}: leave it out", option, who);
    };
    if (who == "passive") return refuse("--trials");
    for (const char* option : {"--step-s", "--press-N", "--force-limit-N", "--encoder-m", "--friction-N"})
        refuse(option);
}

void refuse_equal_cells(const SweepArguments& a, const MapGrid& grid) {
    refuse_twice("--hand", a.hands);
    refuse_twice("--compensators", grid.compensators);
    refuse_twice("--delay-s", grid.delays_s);
    refuse_twice("--jitter-s", grid.jitters_s);
    refuse_twice("--loss", grid.losses);
    refuse_twice(a.gain.empty() ? "--contact-stiffness-N-per-m" : "--gain", grid.stiffness_N_per_m);
}

int run_sweep(const CLI::App& command, SweepArguments arguments) {
    refuse_unused(command, arguments.who);
    const MapGrid grid = grid_of(arguments);
    refuse_equal_cells(arguments, grid);
    install_stop_signals();
    arguments.out = join_ranks(arguments.out).string();
    return run_map(arguments, grid);
}

}  // namespace

Subcommand add_sweep(CLI::App& app) {
    const auto arguments = std::make_shared<SweepArguments>();
    CLI::App* command =
        app.add_subcommand("sweep", "map stability over delay and stiffness, measured and by theory");
    add_sweep_options(*command, *arguments);
    return {command, [command, arguments] { return run_sweep(*command, *arguments); }, true};
}

}  // namespace thimble
