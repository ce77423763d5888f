// The meaning of gathered facts for a session, advice in plain words, and its report. Pure.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "thimble/doctor/facts.hpp"

namespace thimble {

enum class Severity : std::uint8_t {
    kOk,
    kNote,     // something is not there that only other sessions need
    kWarning,  // the session runs, but worse than it could
    kFault,    // the session cannot run
};
const char* to_string(Severity severity);  // "ok", "note", "warning", "fault"

// The result of one check.
struct Diagnosis {
    std::string name;                      // of the check, one or two words
    ExitCode code = ExitCode::kRunFailed;  // of the doctor if this is the first fault
    Severity severity = Severity::kOk;
    std::string says{};                                    // one sentence
    std::string remedy{};                                  // one command of a shell; empty: nothing to mend
    std::vector<std::pair<std::string, double>> values{};  // as measured, names ending in the unit

    Diagnosis& is(Severity how, std::string sentence, std::string command = "") {
        severity = how;
        says = std::move(sentence);
        remedy = std::move(command);
        return *this;
    }
    // Appends to an earlier text; otherwise as is().
    Diagnosis& adds(Severity how, const std::string& words, std::string command = "") {
        return is(how, says + words, std::move(command));
    }
};

// The session itself.
Diagnosis check_session(const Facts& facts);
Diagnosis check_protection(const Facts& facts);
Diagnosis check_programs(const Facts& facts);
Diagnosis check_ports(const Facts& facts);
Diagnosis check_firewall(const Facts& facts);
Diagnosis check_software(const Facts& facts);
Diagnosis check_python(const Facts& facts);
// Time.
Diagnosis check_realtime(const Facts& facts);
Diagnosis check_timer(const Facts& facts);
Diagnosis check_governor(const Facts& facts);
Diagnosis check_clock_source(const Facts& facts);
Diagnosis check_kernel(const Facts& facts);
Diagnosis check_clock(const Facts& facts);
// Devices.
Diagnosis check_handle(const Facts& facts);
Diagnosis check_fingertip(const Facts& facts);
Diagnosis check_device_software(const Facts& facts);
Diagnosis check_can(const Facts& facts);
Diagnosis check_ros2(const Facts& facts);
Diagnosis check_screen(const Facts& facts);
Diagnosis check_sound(const Facts& facts);

// A person's session needs these of this machine: handle, fingertip, their software, screen, sound.
std::vector<Diagnosis> examine_for_person(const Facts& facts);
// All of them, in the order in which they are best mended.
std::vector<Diagnosis> examine(const Facts& facts);

bool can_run(const std::vector<Diagnosis>& findings);
// Of the first fault; ok where the session can run.
ExitCode exit_code(const std::vector<Diagnosis>& findings);
// A line per finding, below it the command that mends it.
std::string to_text(const std::vector<Diagnosis>& findings);
// {"version", "can_run", "findings": [{"name", "severity", "says", "remedy", measured values}]}
nlohmann::ordered_json to_json(const std::vector<Diagnosis>& findings);

}  // namespace thimble
