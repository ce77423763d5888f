#include "experiment/figure_grid.hpp"

#include <fmt/format.h>

namespace thimble {

int FigureGrid::width_px() const {
    const int n = static_cast<int>(columns);
    return left_px + n * panel_width_px + (n - 1) * between_px + right_px;
}

int FigureGrid::height_px() const {
    const int n = static_cast<int>(rows);
    return head_px + n * panel_height_px + (n - 1) * beneath_px + foot_px;
}

std::string FigureGrid::margins(std::size_t row, std::size_t column) const {
    const int left = left_px + static_cast<int>(column) * (panel_width_px + between_px);
    const int top = head_px + static_cast<int>(row) * (panel_height_px + beneath_px);
    const double width = width_px(), height = height_px();
    return fmt::format(
        "set lmargin at screen {:.4f}; set rmargin at screen {:.4f}; set tmargin at screen {:.4f}; "
        "set bmargin at screen {:.4f}\n",
        left / width, (left + panel_width_px) / width, 1 - top / height,
        1 - (top + panel_height_px) / height);
}

std::string FigureGrid::key_place(int y_px) const {
    const double middle = (left_px + width_px() - right_px) / (2.0 * width_px());
    return fmt::format(
        "set key at screen {:.4f}, screen {:.4f} center center horizontal samplen 2.5 width 1\n", middle,
        1 - 1.0 * y_px / height_px());
}

}  // namespace thimble
