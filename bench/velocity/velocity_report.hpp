// The study's table, CSV file and figure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/velocity/velocity_effects.hpp"

namespace thimble {

struct VelocityRow {
    std::string method;   // as in [master] velocity_estimator; "ideal" without an encoder
    std::string setting;  // "20 ms", or nothing
    bool is_default = false;
    VelocityQuality quality;
    TremorResponse tremor;
    PressEffect press;
    EntryEffect entry;
    FixtureEffect fixture;
    double cost_s = 0;
};

// Markdown, for people: millimetres, milliseconds, nanoseconds.
std::string velocity_table(const std::vector<VelocityRow>& rows);
// SI. Without the cost, so that the same seed gives the same bytes.
std::string velocity_csv(const std::vector<VelocityRow>& rows);
// velocity.svg in `directory`: noise against lag, a point per row.
void draw_velocity_figure(const std::vector<VelocityRow>& rows, const std::filesystem::path& directory);

}  // namespace thimble
