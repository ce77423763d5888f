// The doctor's findings for people and for machines.
#pragma once

#include <nlohmann/json.hpp>

#include "thimble/doctor/diagnosis.hpp"

namespace thimble {

bool can_run(const std::vector<Diagnosis>& findings);
// Of the first fault; ok where the session can run.
ExitCode exit_code(const std::vector<Diagnosis>& findings);
// A line per finding, below it the command that mends it.
std::string to_text(const std::vector<Diagnosis>& findings);
// {"version", "can_run", "findings": [{"name", "severity", "says", "remedy", measured values}]}
nlohmann::ordered_json to_json(const std::vector<Diagnosis>& findings);

}  // namespace thimble
