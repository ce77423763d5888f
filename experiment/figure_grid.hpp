// Panels of equal size in rows and columns of one picture, in pixels.
#pragma once

#include <cstddef>
#include <string>

namespace thimble {

struct FigureGrid {
    std::size_t columns = 1, rows = 1;
    int panel_width_px = 260, panel_height_px = 240;
    int left_px = 80, right_px = 12;       // of the whole picture
    int head_px = 40, foot_px = 48;        // of the whole picture
    int between_px = 70, beneath_px = 48;  // from a panel to the next beside it, and below it

    int width_px() const;
    int height_px() const;
    // The gnuplot lines that put what is plotted next there; row 0 is on top.
    std::string margins(std::size_t row, std::size_t column) const;
    // As wide as all panels, its middle `y_px` below the top: for a key.
    std::string key_place(int y_px) const;
};

}  // namespace thimble
