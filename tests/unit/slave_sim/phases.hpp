// Transitions of a tissue by their phase instead of its name.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/messages.hpp"
#include "slave_sim/transitions.hpp"

namespace thimble {

inline TissuePhase phase_named(std::string_view name) {
    for (const TissuePhase phase : {TissuePhase::kFree, TissuePhase::kContact, TissuePhase::kPenetrated}) {
        if (name == to_string(phase)) return phase;
    }
    throw std::runtime_error("unknown phase " + std::string(name));
}

inline std::vector<TissuePhase> phases(const Transitions& transitions) {
    std::vector<TissuePhase> list;
    for (const Transition& t : transitions) list.push_back(phase_named(t.phase));
    return list;
}

}  // namespace thimble
