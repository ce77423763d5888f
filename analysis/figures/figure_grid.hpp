// Panels of equal size in rows and columns of one picture, in pixels, below a key for all of them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "common/messages.hpp"

namespace thimble {

// Of modalities in figures, as in the paper's.
inline constexpr std::array kFigureOrder{Modality::kVF, Modality::kHF, Modality::kCF, Modality::kCCF};

// A line of a key: how gnuplot draws its sample ("with lines linewidth 2") and what stands beside it.
struct KeyEntry {
    std::string style, title;
};

struct FigureGrid {
    std::size_t columns = 1, rows = 1;
    int panel_width_px = 260, panel_height_px = 220;
    int left_px = 92, right_px = 20;       // of the whole picture
    int head_px = 14, foot_px = 60;        // of the whole picture; the head is what is between key and panels
    int between_px = 82, beneath_px = 66;  // from a panel to the next beside it, and below it
    std::vector<KeyEntry> entries;         // of the key

    int width_px() const;
    int height_px() const;
    // The gnuplot lines that put what is plotted next there; row 0 is on top.
    std::string margins(std::size_t row, std::size_t column) const;
    // The key, in as many rows as its width asks for. It is the last plot of a multiplot, because gnuplot would stack the key
    // of a panel to fit that panel. Empty if there are no entries.
    std::string key() const;

  private:
    std::size_t key_columns() const;
    int key_px() const;
};

}  // namespace thimble
