#include "thimble/commands/machines.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "common/own_program.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/text_file.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/launch/remote_starter.hpp"
#include "session/launch/ros2_programs.hpp"
#include "session/launch/unit_files.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

MachineVerdict check_here(const std::string& program) {
    const auto file = program_folder() / program;
    if (std::filesystem::exists(file)) return {};
    return {ExitCode::kRunFailed,
            fmt::format("{} is missing; is Thimble built or installed completely?", file.string())};
}

MachineVerdict check_node(const LaunchSettings& launch, const NodeKind& node,
                          const std::filesystem::path& folder) {
    if (!launch.own_program(node.role).empty()) return {};  // reading the session file has found it
    if (launch.machine(node.role).empty()) return check_here(node.program);
    const auto log = folder / (std::string(node.program) + ".log");
    remove_file(log);
    return check_machine(launch, node.role, node.program, log);
}

void take_ros2_program(const Ros2Program& ros2, LaunchSettings& launch, bool as_services) {
    auto& program = launch.own_programs.at(static_cast<std::size_t>(ros2.role));
    if (!program.empty()) return;
    if (launch.anywhere_else())
        throw Error(
            ExitCode::kUsage,
            "{} device = \"ros2\" works on one machine only: remove the keys machine_... from [launch]",
            ros2.table);
    if (as_services)
        throw Error(ExitCode::kUsage,
                    "{} device = \"ros2\": --print systemd has no unit for {}: start the session with "
                    "'thimble run', without --print",
                    ros2.table, ros2.name);
    program = path_of(ros2);
}

std::string machine_text(const std::string& machine) { return machine.empty() ? "this machine" : machine; }

}  // namespace

void take_ros2_programs(const SystemSettings& settings, LaunchSettings& launch, bool as_services) {
    for (const Ros2Program& ros2 : ros2_programs(settings)) take_ros2_program(ros2, launch, as_services);
}

void print_units(const std::filesystem::path& session, const LaunchSettings& launch,
                 const NetworkSettings& network, const std::filesystem::path& folder) {
    launch.require_no_own_program("a unit of --print systemd");
    const UnitPlan plan{launch, network, read_runtime_settings(ConfigFile::load(session)),
                        session.filename().string()};
    for (const UnitFile& unit : unit_files(plan)) {
        if (folder.empty()) {
            fmt::print("{}\n", unit.text);
            continue;
        }
        const auto file = folder / machine_text(unit.machine) / unit.name;
        make_folder(file.parent_path());
        write_text_file(file, unit.text);
        fmt::print("{}\n", file.string());
    }
}

ExitCode check_machines(const LaunchSettings& launch, const std::filesystem::path& folder, bool json) {
    make_folder(folder);
    ExitCode worst = ExitCode::kOk;
    nlohmann::ordered_json all;
    for (const NodeKind& node : kNodes) {
        const std::string& machine = launch.machine(node.role);
        const MachineVerdict verdict = check_node(launch, node, folder);
        if (worst == ExitCode::kOk) worst = verdict.code;
        all[node.program] = {{"machine", machine}, {"problem", verdict.problem}};
        if (json) continue;
        const auto& own = launch.own_program(node.role);
        fmt::print("{} on {}: {}\n", own.empty() ? node.program : own.string(), machine_text(machine),
                   verdict.code == ExitCode::kOk ? "good" : verdict.problem);
    }
    if (json) fmt::print("{}\n", json_text(all, 2));
    return worst;
}

}  // namespace thimble
