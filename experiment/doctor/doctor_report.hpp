// The doctor's findings for people and for machines.
#pragma once

#include <nlohmann/json.hpp>

#include "experiment/doctor/finding.hpp"

namespace thimble {

bool can_run(const std::vector<Finding>& findings);
// Of the first fault; ok where the session can run.
ExitCode exit_code(const std::vector<Finding>& findings);
// A line per finding, below it the command that mends it.
std::string to_text(const std::vector<Finding>& findings);
// {"version", "can_run", "findings": [{"name", "severity", "says", "remedy", measured values}]}
nlohmann::ordered_json to_json(const std::vector<Finding>& findings);

}  // namespace thimble
