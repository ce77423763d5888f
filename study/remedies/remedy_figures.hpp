// Figures of the comparison of remedies: a line per condition over the delay, and where each is stable.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/figures/figures.hpp"
#include "study/remedies/remedy_study.hpp"

namespace thimble {

// Every trial completed, none oscillating.
bool is_stable(const RemedyRow& row);

// A measure of a row, as shown.
struct RemedyMeasure {
    std::string_view name;   // of files
    std::string_view label;  // for people, with its unit
    int decimals;
    bool logarithmic;
    double (*value)(const RemedyRow&);  // in that unit
};
const std::vector<RemedyMeasure>& remedy_measures();

// Of rows without jitter and loss; the others are in the matrix.
std::vector<FigureSource> delay_figures(const std::vector<RemedyRow>& rows);
FigureSource matrix_figure(const std::vector<RemedyRow>& rows);

// Conditions and networks in the order of the rows, each once.
std::vector<std::string> conditions_in(const std::vector<RemedyRow>& rows);
std::vector<RemedyNetwork> networks_in(const std::vector<RemedyRow>& rows);
// Null if there is none.
const RemedyRow* find_row(const std::vector<RemedyRow>& rows, std::string_view condition,
                          std::string_view network);

}  // namespace thimble
