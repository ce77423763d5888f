// A table as a picture: the darker a cell, the larger its percentage; with a text in each.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/text/gnuplot.hpp"
#include "common/colours.hpp"

namespace thimble {

struct HeatCell {
    std::size_t column = 0, row = 0;  // row 0 is on top
    double percent = 0;
    std::string text;
};

struct HeatMap {
    std::vector<std::string> columns, rows;  // their names; "\n" begins another line of a column's
    std::vector<HeatCell> cells;             // those that there are
    std::string x_label;                     // may be empty
    std::string percent_of;                  // "trials that oscillate": beside the scale of colours
    std::string text_is;                     // what the text of a cell says
    Colour darkest{};
};

// Title and caption are left to the caller.
FigureSource heat_map_figure(const HeatMap& map, const std::string& name);

}  // namespace thimble
