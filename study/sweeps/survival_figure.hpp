// Which claims come out where: claims down, the parameter across, the darker the more often.
#pragma once

#include <filesystem>

#include "analysis/figures/figures.hpp"
#include "study/sweeps/variation.hpp"

namespace thimble {

// Into OUTPUT/figures; failure becomes `problem`, as in draw_figures.
DrawnFigures draw_survival(const Variation& variation, const std::filesystem::path& output);

}  // namespace thimble
