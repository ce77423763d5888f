// Findings of a comparison, as sentences made from its data.
#pragma once

#include <string>
#include <vector>

#include "study/remedies/remedy_figures.hpp"

namespace thimble {

// The rows condensed from the trials, all of them. Sentences for people, most important first.
std::vector<std::string> remedy_findings(const std::vector<RemedyRow>& rows,
                                         const std::vector<RemedyTrial>& trials);

}  // namespace thimble
