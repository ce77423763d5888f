// A map: cells of two axes in the colours of their classes, and a curve of theory over them. Panels share axes, classes and key.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "analysis/text/gnuplot.hpp"
#include "common/colours.hpp"

namespace thimble {

struct CellClass {
    char label;
    Colour colour;
    std::string title;
};

struct CellMapPanel {
    std::string title;
    std::vector<char> labels;   // x by x, in each of them y by y; of no class: no cell
    std::vector<double> curve;  // by x; not finite: no point
};

struct CellMap {
    std::string x_label, y_label;
    std::vector<double> x, y;  // the middles of the cells, in any order
    bool logarithmic_y = false;
    std::vector<CellClass> classes;
    std::vector<CellMapPanel> panels;
    std::size_t columns = 1;  // of panels
    std::string curve_title;
    std::vector<std::pair<double, std::string>> marks;  // dashed lines at a y
};

// The outcomes of a held force loop, by the letters of HoldClass.
std::vector<CellClass> outcome_classes();

// Title and caption are left to the caller.
FigureSource cell_map_figure(const CellMap& map, const std::string& name);

}  // namespace thimble
