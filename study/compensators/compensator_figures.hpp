// Figures of the comparison of compensators: a line per condition over the delay, and where each is stable.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/figures/figures.hpp"
#include "study/compensators/compensator_study.hpp"

namespace thimble {

// Every trial completed, none oscillating.
bool is_stable(const CompensatorRow& row);

// A measure of a row, as shown.
struct CompensatorMeasure {
    std::string_view name;   // of files
    std::string_view label;  // for people, with its unit
    int decimals;
    bool logarithmic;
    double (*value)(const CompensatorRow&);  // in that unit
};
const std::vector<CompensatorMeasure>& compensator_measures();

// Of rows without jitter and loss; the others are in the matrix.
std::vector<FigureSource> delay_figures(const std::vector<CompensatorRow>& rows);
FigureSource matrix_figure(const std::vector<CompensatorRow>& rows);

// Conditions and networks in the order of the rows, each once.
std::vector<std::string> conditions_in(const std::vector<CompensatorRow>& rows);
std::vector<CompensatorNetwork> networks_in(const std::vector<CompensatorRow>& rows);
// Null if there is none.
const CompensatorRow* find_row(const std::vector<CompensatorRow>& rows, std::string_view condition,
                               std::string_view network);

}  // namespace thimble
