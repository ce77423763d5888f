// thimble up: what `thimble run` does, with each node on the machine where it belongs.
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/text_file.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/launch/node_starter.hpp"
#include "session/launch/port_table.hpp"
#include "session/launch/remote_starter.hpp"
#include "session/launch/unit_files.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/real_run.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct UpArguments : RealRunArguments {
    std::string exec, programs, print;
    bool check = false;
};

LaunchSettings launch_of(const UpArguments& arguments, const SystemSettings& settings) {
    LaunchSettings launch = settings.launch;
    if (!arguments.exec.empty()) launch.exec = arguments.exec;
    if (!arguments.programs.empty()) launch.programs = arguments.programs;
    if (exec_words(launch, "x").empty())
        throw Error(ExitCode::kUsage, "--exec is empty: leave it out for ssh");
    return launch;
}

int print_units(const UpArguments& arguments, const LaunchSettings& launch) {
    const bool to_files = arguments.out_option->count() > 0;
    const std::filesystem::path session(arguments.config);
    const UnitPlan plan{launch, network_of(arguments.config, arguments.base_port),
                        read_runtime_settings(ConfigFile::load(session)), session.filename().string()};
    for (const UnitFile& unit : unit_files(plan)) {
        if (!to_files) {
            fmt::print("{}\n", unit.text);
            continue;
        }
        const auto folder =
            arguments.run.out / (unit.machine.empty() ? std::string("this machine") : unit.machine);
        make_folder(folder);
        write_text_file(folder / unit.name, unit.text);
        fmt::print("{}\n", (folder / unit.name).string());
    }
    return 0;
}

MachineVerdict check_here(const std::string& program) {
    const auto file = program_folder() / program;
    if (std::filesystem::exists(file)) return {};
    return {ExitCode::kRunFailed,
            fmt::format("{} is not there; is Thimble built or installed completely?", file.string())};
}

// A line per node; as JSON one object of machine and problem per node.
int check_machines(const UpArguments& arguments, const LaunchSettings& launch) {
    const auto folder = arguments.run.out / "check";
    make_folder(folder);
    ExitCode worst = ExitCode::kOk;
    nlohmann::ordered_json all;
    for (const NodeKind& node : kNodes) {
        const std::string& machine = launch.machine(node.role);
        const auto log = folder / (std::string(node.program) + ".log");
        std::filesystem::remove(log);
        const MachineVerdict verdict =
            machine.empty() ? check_here(node.program) : check_machine(launch, node.role, node.program, log);
        if (worst == ExitCode::kOk) worst = verdict.code;
        all[node.program] = {{"machine", machine}, {"problem", verdict.problem}};
        if (arguments.json) continue;
        fmt::print("{} on {}: {}\n", node.program, machine.empty() ? "this machine" : machine,
                   verdict.code == ExitCode::kOk ? "good" : verdict.problem);
    }
    if (arguments.json) fmt::print("{}\n", json_text(all, 2));
    return static_cast<int>(worst);
}

int go_up(const UpArguments& arguments) {
    const SystemSettings settings = load_system_settings(arguments.config);
    const LaunchSettings launch = launch_of(arguments, settings);
    const NetworkSettings network = network_of(arguments.config, arguments.base_port);
    check_hosts(launch, network);
    if (arguments.print == "systemd") return print_units(arguments, launch);
    if (arguments.print == "ports") {
        fmt::print("{}", firewall_table(network, launch));
        return 0;
    }
    auto here = std::make_unique<LocalStarter>(program_folder(), arguments.config);
    const auto starter = std::make_shared<RemoteStarter>(launch, arguments.config, std::move(here));
    if (arguments.check) return check_machines(arguments, launch);
    return run_for_real(arguments, settings, starter);
}

}  // namespace

Subcommand add_up(CLI::App& app, const std::string& typed) {
    const auto arguments = std::make_shared<UpArguments>();
    UpArguments& a = *arguments;
    a.run.command = typed;
    CLI::App* up =
        app.add_subcommand("up",
                           "the same as run, with each node on the machine that the session file's [launch] "
                           "names: starts them over "
                           "ssh, runs the trials, gathers logs and reports, and leaves nothing running");
    add_real_run_options(*up, "out/up", a);
    up->add_option("--exec", a.exec, "what runs a command on {host}, instead of [launch].exec (ssh)")
        ->type_name("COMMAND");
    up->add_option("--programs", a.programs, "folder of the programs there, instead of [launch].programs")
        ->type_name("FOLDER");
    up->add_flag("--check", a.check,
                 "start nothing: is each machine reached, has it the program, in this version?");
    up->add_option(
          "--print", a.print,
          "start nothing: print units for services (into folders, with --out), or the ports that cross "
          "between machines")
        ->check(CLI::IsMember({"systemd", "ports"}));
    up->footer(
        "Examples:\n  thimble up deploy/sessions/three_machines.toml --check\n"
        "  thimble up deploy/sessions/three_machines.toml --out out/up\n"
        "  thimble up session.toml --exec \"ip netns exec {host}\" --programs /opt/thimble/bin\n"
        "  thimble up session.toml --print systemd --out units\n\n"
        "docs/machines.md is the manual.");
    return {up, [arguments] { return go_up(*arguments); }};
}

}  // namespace thimble
