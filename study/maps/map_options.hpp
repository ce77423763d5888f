// The arguments of thimble sweep, and their effect.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/csv/csv_file.hpp"
#include "study/maps/map_grid.hpp"

namespace thimble {

struct SweepArguments {
    std::vector<std::string> hands{"D"},
        compensators;                   // no compensators: the session's modalities, else "none"
    std::optional<double> own_mass_kg;  // with the rest of own_hand: instead of `hands`
    HeldMass own_hand;
    std::string delays, stiffness, gain, jitters = "0", losses = "0", who = "passive";
    std::string session, out;
    std::optional<std::uint64_t> seed;
    MapGrid rest;
    unsigned jobs = 0;
    std::size_t block = 0;
    IfExists if_exists = IfExists::kRefuse;
};

// Throws Error (usage).
MapGrid grid_of(const SweepArguments& arguments);
// Block size: at most a column, whose cells share their theory, and small enough that all workers have work to the
// end.
std::size_t block_of(const SweepArguments& arguments, const MapGrid& grid, std::size_t hands);
// Table and figure; the exit code.
int run_map(const SweepArguments& arguments, const MapGrid& grid);
// map.svg in `folder` from its map.csv: outcomes as points, a panel for each hand, compensator, jitter and loss, the boundary of
// the theory over them. Says what is missing instead if there is no gnuplot or there are more than 36 panels.
void draw_map(const std::filesystem::path& folder, const MapGrid& grid);

}  // namespace thimble
