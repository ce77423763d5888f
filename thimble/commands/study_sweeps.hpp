// thimble study over many seeds, values of a parameter, or draws: runs it and prints how often each claim comes out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "study/sweeps/seed_sweep.hpp"

namespace thimble {

struct SweepRequest {
    std::vector<std::string> vary;  // as typed: NAME=LOW:HIGH[:POINTS]
    std::uint32_t draws = 0;        // 0: none; then `vary` without points
    bool asked() const { return !vary.empty() || draws > 0; }
};

// Both return the exit code. Settings and options are those of the study.
int sweep_seeds(const SystemSettings& settings, const SweepOptions& options);
int sweep_parameters(const std::filesystem::path& config, const SweepRequest& request, SweepOptions options);

}  // namespace thimble
