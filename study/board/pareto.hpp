// Contestants over all conditions, ranked by Pareto fronts: no weights between depth and packets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "study/board/board_row.hpp"

namespace thimble {

enum Objective : std::size_t { kUnstable, kDepth, kFelt, kAway, kSent, kObjectives };
struct ObjectiveRule {
    const char* name;
    double least;  // a smaller difference is none
    bool more;     // more is better
};
inline constexpr std::array<ObjectiveRule, kObjectives> kObjectiveRules{{{"unstable_share", 0.01, false},
                                                                         {"penetration_max_m", 1e-4, false},
                                                                         {"rendered_stiffness", 0.02, true},
                                                                         {"drift_needle_m", 1e-4, false},
                                                                         {"packets_per_s", 20, false}}};

struct Contestant {
    std::string name;  // the controller, and the codec where there are several
    std::size_t rows = 0, stable_rows = 0, failed_rows = 0;  // failed: without measures
    std::array<BoardValue, kObjectives> values{};            // means over rows
    std::size_t front = 0;  // 1: no other contestant dominates it; 0: not ranked, a row has no measures
    std::vector<std::string> dominated_by{};
};

// Beyond both 90 % intervals and by more than the objective's least difference.
bool is_better(const BoardValue& a, const BoardValue& b, Objective objective);
// True if b is better in no objective and a in at least one.
bool dominates(const Contestant& a, const Contestant& b);

// In the order of the rows.
std::vector<Contestant> rank_contestants(const std::vector<BoardRow>& rows);

}  // namespace thimble
