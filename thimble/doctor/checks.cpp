#include "thimble/doctor/checks.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "common/version.hpp"

namespace thimble {
namespace {

std::vector<Diagnosis>::const_iterator first_fault(const std::vector<Diagnosis>& findings) {
    return std::find_if(findings.begin(), findings.end(),
                        [](const Diagnosis& finding) { return finding.severity == Severity::kFault; });
}

}  // namespace

const char* to_string(Severity severity) {
    static constexpr std::array kNames{"ok", "note", "warning", "fault"};
    return kNames.at(static_cast<std::size_t>(severity));
}

std::vector<Diagnosis> examine(const Facts& facts) {
    constexpr std::array kChecks{check_session,      check_protection,      check_programs, check_ports,
                                 check_firewall,     check_realtime,        check_timer,    check_governor,
                                 check_clock_source, check_kernel,          check_clock,    check_handle,
                                 check_fingertip,    check_device_software, check_can,      check_ros2,
                                 check_screen,       check_sound,           check_software, check_python};
    std::vector<Diagnosis> findings;
    findings.reserve(kChecks.size());
    for (const auto check : kChecks) findings.push_back(check(facts));
    return findings;
}

std::vector<Diagnosis> examine_for_person(const Facts& facts) {
    return {check_handle(facts), check_fingertip(facts), check_device_software(facts),
            check_ros2(facts),   check_screen(facts),    check_sound(facts)};
}

bool can_run(const std::vector<Diagnosis>& findings) { return first_fault(findings) == findings.end(); }

ExitCode exit_code(const std::vector<Diagnosis>& findings) {
    const auto fault = first_fault(findings);
    return fault == findings.end() ? ExitCode::kOk : fault->code;
}

std::string to_text(const std::vector<Diagnosis>& findings) {
    std::string text;
    for (const Diagnosis& finding : findings) {
        text += fmt::format("{:8} {:13} {}\n", to_string(finding.severity), finding.name, finding.says);
        if (!finding.remedy.empty()) text += fmt::format("{:22} $ {}\n", "", finding.remedy);
    }
    const auto fault = first_fault(findings);
    return text + (fault == findings.end() ? "A session can run here.\n"
                                           : fmt::format("A session cannot run here: {}.\n", fault->name));
}

nlohmann::ordered_json to_json(const std::vector<Diagnosis>& findings) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Diagnosis& finding : findings) {
        nlohmann::ordered_json entry{{"name", finding.name},
                                     {"severity", to_string(finding.severity)},
                                     {"says", finding.says},
                                     {"remedy", finding.remedy}};
        for (const auto& [name, value] : finding.values) entry[name] = value;
        list.push_back(std::move(entry));
    }
    return {{"version", kVersion}, {"can_run", can_run(findings)}, {"findings", std::move(list)}};
}

}  // namespace thimble
