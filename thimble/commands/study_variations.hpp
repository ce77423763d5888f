// thimble study over many seeds, along parameters, or over joint draws of them; says what comes out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study/sweeps/judged_study.hpp"

namespace thimble {

struct SweepRequest {
    std::vector<std::string> vary;  // as typed: NAME=LOW:HIGH[:POINTS]
    std::uint32_t draws = 0;        // 0: none; then `vary` without points
    bool asked() const { return !vary.empty() || draws > 0; }
};

// The exit code.
int sweep_seeds(const SystemSettings& settings, const SweepOptions& options);
int sweep_parameters(const std::filesystem::path& config, const SweepRequest& request, SweepOptions options);

}  // namespace thimble
