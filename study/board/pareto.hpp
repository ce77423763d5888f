// Contestants over all their conditions, ranked by Pareto fronts: no weight says how much depth a packet is worth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "study/board/board_row.hpp"

namespace thimble {

enum Objective : std::size_t { kUnstable, kDepth, kFelt, kSent, kObjectives };
inline constexpr std::array<const char*, kObjectives> kObjectiveNames{"unstable_share", "penetration_max_m",
                                                                      "rendered_stiffness", "packets_per_s"};

struct Contestant {
    std::string name;  // the controller, and the codec where there are several
    std::size_t rows = 0, stable_rows = 0, failed_rows = 0;  // failed: without measures
    std::array<BoardValue, kObjectives> values{};            // means over rows
    std::size_t front = 0;  // 1: nobody dominates it; 0: not ranked, a row has no measures
    std::vector<std::string> dominated_by{};
};

// Beyond both 90 % intervals and by more than 2 %, in the objective's direction.
bool is_better(const BoardValue& a, const BoardValue& b, Objective objective);
// In no objective is b better, and in one at least a is.
bool dominates(const Contestant& a, const Contestant& b);

// In the order of the rows.
std::vector<Contestant> rank_contestants(const std::vector<BoardRow>& rows);

}  // namespace thimble
