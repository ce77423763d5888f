// thimble doctor: what keeps a session from running well on this machine, and the command that mends it.
#include <algorithm>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/json_text.hpp"
#include "common/network_settings.hpp"
#include "common/own_program.hpp"
#include "common/runtime/udp_channel.hpp"
#include "session/settings/system_settings.hpp"
#include "session/virtual/energy_demand.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/run.hpp"
#include "thimble/commands/shared.hpp"
#include "thimble/doctor/checks.hpp"
#include "thimble/doctor/facts.hpp"

namespace thimble {
namespace {

struct DoctorArguments {
    std::string session;
    int base_port = 0;
    double seconds_s = 1;
    bool json = false;
};

bool needs_other_machines(const NetworkSettings& network) {
    return std::any_of(network.hosts.begin(), network.hosts.end(),
                       [](const std::string& host) { return !means_this_machine(host); });
}

// A session file that cannot be read is a finding; the rest is then looked at for the default session.
ConfigFile read_session(const DoctorArguments& arguments, SystemSettings& settings, SessionFacts& facts) {
    facts.file = arguments.session;
    ConfigFile file = ConfigFile::empty();
    try {
        settings = load_system_settings(arguments.session);
        if (!arguments.session.empty()) file = ConfigFile::load(arguments.session);
    } catch (const Error& error) {
        facts.problem = fmt::format("{}; the lines below are of the default session", error.what());
        facts.problem_code = error.code();
    }
    gather_session(file, settings, facts);
    gather_services(settings, facts);
    try {
        facts.energy = energy_warning(settings);
    } catch (const Error& error) {  // of a plug-in
        facts.problem = error.what();
        facts.problem_code = error.code();
    }
    return file;
}

int examine_machine(const DoctorArguments& arguments) {
    Facts facts;
    SystemSettings settings;
    const ConfigFile file = read_session(arguments, settings, facts.session);
    const NetworkSettings network = read_network_settings(file);
    facts.session.several_machines = needs_other_machines(network);
    facts.protection = gather_protection(network, settings);
    const int base_port = arguments.base_port != 0 ? arguments.base_port : network.base_port;
    facts.programs = gather_programs(program_folder());
    facts.ports = gather_ports(
        static_cast<std::uint16_t>(base_port),
        conditions_at_once(settings, settings.plan.delays.size(), settings.launch.anywhere_else()));
    facts.firewall = gather_firewall("/");
    facts.ros2 = gather_ros2(file, settings);
    gather_time(file, arguments.seconds_s, facts.realtime, facts.timer);
    facts.processors = gather_processors("/");
    facts.kernel = gather_kernel("/");
    facts.clock = gather_clock();
    facts.devices = gather_devices("/");
    facts.can = gather_can("/");
    facts.screen = gather_screen();
    facts.sound = gather_sound();
    const std::vector<Diagnosis> findings = examine(facts);
    fmt::print("{}", arguments.json ? json_text(to_json(findings), 2) + "\n" : to_text(findings));
    return static_cast<int>(exit_code(findings));
}

}  // namespace

Subcommand add_doctor(CLI::App& app) {
    const auto arguments = std::make_shared<DoctorArguments>();
    DoctorArguments& a = *arguments;
    CLI::App* command = app.add_subcommand(
        "doctor", "check whether a session can run well on this machine, and print how to fix each problem");
    add_session_option(*command, a.session,
                       "session file (TOML) or built-in name; default: the default session");
    add_base_port_option(*command, a.base_port);
    command->add_option("--seconds", a.seconds_s, "how long to measure the timer, s")
        ->check(CLI::Range(0.01, 3600.0))
        ->capture_default_str();
    command->add_flag("--json", a.json, "print JSON on stdout, instead of a table");
    command->footer(
        "The command changes nothing and needs no root.\n"
        "note: affects other sessions only; warning: the session runs, but not well; fault: it cannot run.\n"
        "\n"
        "Examples:\n"
        "  thimble doctor\n"
        "  thimble doctor deploy/sessions/delay50.toml --seconds 10\n"
        "  thimble doctor --json | jq '.findings[] | select(.severity != \"ok\")'\n"
        "\n"
        "Exit codes: 0 the session can run, else by the first fault: 1 a program or device is missing, or "
        "a plug-in fails, 2 session file, protection or screen, 3 ports, 4 time, 5 a key file is damaged.");
    return {command, [arguments] { return examine_machine(*arguments); }};
}

}  // namespace thimble
