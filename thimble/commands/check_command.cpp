// thimble check: what is wrong with a session file, or which trials it means.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "session/participant/order_file.hpp"
#include "session/participant/run_participant.hpp"
#include "session/records/condition_summary.hpp"
#include "session/settings/protocol.hpp"
#include "session/settings/system_settings.hpp"
#include "session/virtual/energy_demand.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/machines.hpp"
#include "thimble/commands/shared.hpp"
#include "thimble/doctor/checks.hpp"
#include "thimble/doctor/facts.hpp"

namespace thimble {
namespace {

std::string conditions_text(const SessionPlan& plan) {
    std::vector<std::string> delays, modalities;
    for (const Duration delay : plan.delays) delays.push_back(delay_text(to_seconds(delay)));
    for (const Modality modality : plan.modalities) modalities.emplace_back(to_string(modality));
    return fmt::format("delay of the force path {}; modalities {}", fmt::join(delays, ", "),
                       fmt::join(modalities, ", "));
}

std::string run_text(const SystemSettings& settings, const NetworkSettings& network) {
    const SessionPlan& plan = settings.plan;
    LaunchSettings launch = settings.launch;
    take_ros2_programs(settings, launch, false);
    check_hosts(launch, network);
    if (settings.protocol) {
        check_virtual_subject(settings);
        const std::uint32_t participant = std::max(1U, plan.subject);  // 0: --participant says it
        return fmt::format(
            "a session of {} trials ({} of them for practice) with one of {} planned participants",
            plan_order(settings, participant).size(), settings.protocol->practice_trials,
            settings.protocol->subjects);
    }
    if (plan.kind == SubjectKind::kHuman)
        throw Error(ExitCode::kUsage,
                    "[session] subject names a person, so the file needs a table [protocol]: add it "
                    "(docs/real-subjects.md)");
    return fmt::format("{} trials, one for each delay and modality, with virtual subject {}",
                       plan.delays.size() * plan.modalities.size(), plan.subject);
}

std::string study_text(const SystemSettings& settings, bool paper) {
    require_virtual_subjects(settings, "study");
    std::uint64_t trials = 0;
    const std::vector<Protocol> protocols = session_protocols(settings);
    for (const Protocol& protocol : protocols)
        trials += std::uint64_t{protocol.subjects} * subject_trials(protocol, 1).size();
    return fmt::format("{} trials with {} virtual subject{}{}", trials, protocols[0].subjects,
                       protocols[0].subjects == 1 ? "" : "s",
                       paper ? ", and a test of the paper's claims" : "");
}

// A line for each command, which says the same as the command: also why it refuses the session.
void say(const char* command, const std::function<std::string()>& text) {
    try {
        fmt::print("thimble {}: {}\n", command, text());
    } catch (const Error& refusal) {
        fmt::print("thimble {}: does not accept this session: {}\n", command, refusal.what());
    }
}

// The file is good; whether this machine suits a person's session is another question, which thimble doctor answers by its exit code.
void say_for_person(const SystemSettings& settings) {
    Facts facts;
    const ConfigFile file = ConfigFile::load(settings.file);
    gather_session(file, settings, facts.session);
    facts.ros2 = gather_ros2(file, settings);
    facts.devices = gather_devices("/");
    facts.screen = gather_screen();
    facts.sound = gather_sound();
    for (const Diagnosis& finding : examine_for_person(facts))
        if (finding.severity >= Severity::kWarning)
            fmt::print("this machine: {}: {}: {}\n", to_string(finding.severity), finding.name, finding.says);
    const bool delayed = settings.plan.delays != std::vector{Duration{0}};
    if (delayed && settings.protocol && settings.protocol->repeat_timeouts)
        spdlog::warn(
            "[protocol] repeat_timeouts = true also repeats trials that time out because they oscillate. "
            "With "
            "a delay the results then lack such trials: set it to false");
}

int check_config(const std::string& config) {
    const SystemSettings settings = load_system_settings(config);
    check_build(settings);
    // These two read the file: if that fails, no command refuses.
    const bool paper = is_paper_session(settings.file);
    const NetworkSettings network = network_of(settings.file.string(), 0);
    for (const std::string& warning : named_modalities(settings.pages.instructions)) spdlog::warn(warning);
    if (const std::string warning = energy_warning(settings); !warning.empty()) spdlog::warn(warning);
    fmt::print("{}: no errors\n{}\n", config, conditions_text(settings.plan));
    say("run", [&] { return run_text(settings, network); });
    say("study", [&] { return study_text(settings, paper); });
    if (settings.plan.kind == SubjectKind::kHuman) say_for_person(settings);
    return 0;
}

}  // namespace

Subcommand add_check(CLI::App& app) {
    const auto config = std::make_shared<std::string>();
    CLI::App* check =
        app.add_subcommand("check", "check a session file: print its error, or the trials that it plans");
    add_session_option(*check, *config, "session: a TOML file, or one that comes with the program")
        ->required();
    check->footer("Examples:\n  thimble check my-session.toml\n  thimble check paper-experiment-3");
    return {check, [config] { return check_config(*config); }};
}

}  // namespace thimble
