// A map: which loops are run. Cells are numbered; delay against stiffness makes a panel, panels are told apart by hand, compensator,
// jitter and loss. In a panel stiffness runs fastest, then delay. Everything here follows from the command line alone, so that
// every rank and a later run number the same cells alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/shared_values.hpp"
#include "stability/critical_delay.hpp"

namespace thimble {

struct NamedHand {
    std::string name;
    HeldMass hand;
};
// A light pinch, B pinch, C measured arm, D firm grip, E power grip (docs/stability.md). Throws Error (usage) for any other letter.
NamedHand named_hand(std::string_view letter);

enum class MapOperator : std::uint8_t { kPassive, kVirtual };

struct MapGrid {
    MapOperator who = MapOperator::kPassive;
    std::vector<NamedHand> hands;
    std::vector<std::string>
        compensators;  // "none" or a name of [control] compensator; virtual operator: CF, CCF, VF as well
    std::vector<double> jitters_s, losses, delays_s, stiffness_N_per_m;

    double mean_burst = 1;
    double step_s = 1e-3, press_N = 5, force_limit_N = kHandleFullScale_N, encoder_step_m = 1e-5,
           friction_N = 0;
    double full_stiffness_N_per_m = 9000;  // of gain 1
    std::uint64_t seed = 1;
    std::uint32_t trials = 1;  // of a virtual operator, each another subject
    std::string config;        // its session file

    std::size_t column() const { return stiffness_N_per_m.size(); }
    std::size_t panel() const { return delays_s.size() * column(); }
    std::size_t panels() const {
        return hands.size() * compensators.size() * jitters_s.size() * losses.size();
    }
    std::size_t cells() const { return panels() * panel(); }
};

struct CellPlace {
    std::size_t hand, compensator, jitter, loss, delay, stiffness;
};
CellPlace place_of(const MapGrid& grid, std::size_t cell);

// "0,0.05" as it stands, or "LOW:HIGH:POINTS", evenly in the value or in its logarithm. Throws Error (usage) that names the option.
std::vector<double> parse_map_axis(const std::string& option, const std::string& text, bool logarithmic);

// Throws Error (usage) for what no cell could be made of.
void require_meaningful(const MapGrid& grid);
// The text that decides the table's bytes: another text is another map.
std::string grid_text(const MapGrid& grid);

}  // namespace thimble
