// The picture of a map: outcomes as points, a panel for each hand, compensator, jitter and loss, the boundary of the theory over them.
#pragma once

#include <filesystem>

#include "study/maps/map_grid.hpp"

namespace thimble {

inline constexpr std::size_t kMostPanels = 36;

// map.svg in `folder` from its map.csv. Says what is missing instead if there is no gnuplot or there are too many panels.
void draw_map(const std::filesystem::path& folder, const MapGrid& grid);

}  // namespace thimble
