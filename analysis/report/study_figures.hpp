// Figures of a study's report. One gnuplot draws all figures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "analysis/figures/figures.hpp"

namespace thimble {

struct StudyFigures {
    DrawnFigures side_by_side;                          // of a study with more than one experiment
    std::map<std::uint32_t, DrawnFigures> experiments;  // each that has panels
};
// Into OUTPUT/figures; names end in "_experiment1" where there are several. Failure becomes the `problem` of
// those that miss a figure.
StudyFigures draw_study(const std::vector<TrialRow>& rows, const PanelsByExperiment& panels,
                        const std::filesystem::path& output);

}  // namespace thimble
