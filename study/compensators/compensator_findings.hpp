// Findings of a comparison, as sentences made from its data.
#pragma once

#include <string>
#include <vector>

#include "study/compensators/compensator_figures.hpp"

namespace thimble {

// The rows condensed from the trials, all of them. Sentences for people, most important first.
std::vector<std::string> compensator_findings(const std::vector<CompensatorRow>& rows,
                                              const std::vector<CompensatorTrial>& trials);

}  // namespace thimble
