#include "analysis/figures/figure_grid.hpp"

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

std::string FigureGrid::key(const std::string& entries) const {
    constexpr int kHeight_px = 36;
    return fmt::format(
        "unset border; unset tics; unset xlabel; unset ylabel; unset title; unset arrow; unset logscale\n"
        "set xrange [0:1]; set yrange [0:1]; set offsets 0, 0, 0, 0\n"
        "set lmargin at screen {:.4f}; set rmargin at screen {:.4f}; set tmargin at screen 1; "
        "set bmargin at screen {:.4f}\n"
        "set key center center horizontal samplen 2.5 textcolor '#222222'\nplot {}\n",
        1.0 * left_px / width_px(), 1 - 1.0 * right_px / width_px(), 1 - 1.0 * kHeight_px / height_px(),
        entries);
}

}  // namespace thimble
