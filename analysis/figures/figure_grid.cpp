#include "analysis/figures/figure_grid.hpp"

#include <algorithm>

#include <boost/algorithm/string/replace.hpp>
#include <fmt/format.h>

namespace thimble {
namespace {

constexpr int kKeyLine_px = 20, kKeyMargin_px = 6, kSample_px = 62, kCharacter_px = 8;

}  // namespace

int FigureGrid::width_px() const {
    const int n = static_cast<int>(columns);
    return left_px + n * panel_width_px + (n - 1) * between_px + right_px;
}

int FigureGrid::height_px() const {
    const int n = static_cast<int>(rows);
    return key_px() + head_px + n * panel_height_px + (n - 1) * beneath_px + foot_px;
}

// gnuplot makes all columns of a key as wide as its longest title.
std::size_t FigureGrid::key_columns() const {
    std::size_t longest = 0;
    for (const KeyEntry& entry : entries) longest = std::max(longest, entry.title.size());
    const int column_px = kSample_px + kCharacter_px * static_cast<int>(longest);
    const auto most = static_cast<std::size_t>(std::max(1, (width_px() - right_px) / column_px));
    const std::size_t lines = (entries.size() + most - 1) / most;
    return lines > 0 ? (entries.size() + lines - 1) / lines : 1;
}

int FigureGrid::key_px() const {
    if (entries.empty()) return 0;
    const std::size_t lines = (entries.size() + key_columns() - 1) / key_columns();
    return kKeyMargin_px + kKeyLine_px * static_cast<int>(lines);
}

std::string FigureGrid::margins(std::size_t row, std::size_t column) const {
    const int left = left_px + static_cast<int>(column) * (panel_width_px + between_px);
    const int top = key_px() + head_px + static_cast<int>(row) * (panel_height_px + beneath_px);
    const double width = width_px(), height = height_px();
    return fmt::format(
        "set lmargin at screen {:.4f}; set rmargin at screen {:.4f}; set tmargin at screen {:.4f}; set "
        "bmargin at screen {:.4f}\n",
        left / width, (left + panel_width_px) / width, 1 - top / height,
        1 - (top + panel_height_px) / height);
}

std::string FigureGrid::key() const {
    if (entries.empty()) return "";
    std::string script = fmt::format(
        "unset border; unset tics; unset xlabel; unset ylabel; unset title; unset arrow; unset label\n"
        "unset logscale; set xrange [0:1]; set yrange [0:1]; set offsets 0, 0, 0, 0\n"
        "set lmargin at screen 0; set rmargin at screen 1; set tmargin at screen 1; set bmargin at screen "
        "{:.4f}\n"
        "set key center center horizontal Left reverse maxcols {} samplen 2.5 textcolor '#222222'\nplot NaN "
        "notitle",
        1 - 1.0 * key_px() / height_px(), key_columns());
    for (const KeyEntry& entry : entries)  // they alone would be no plot
        script += fmt::format(", \\\n     keyentry {} title '{}'", entry.style,
                              boost::replace_all_copy(entry.title, "'", "''"));
    return script + "\n";
}

}  // namespace thimble
