// A needle's path through a scene, offline: positions, forces and events as files.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>

#include "session/records/needle_file.hpp"
#include "slave_sim/needle_scene.hpp"

namespace thimble {

struct ReplayOptions {
    std::filesystem::path scene;
    std::filesystem::path needle;
    std::filesystem::path out;     // replaced if it exists
    std::filesystem::path events;  // empty: beside `out`
    std::string solver = "exact";
    double solver_step_s = 1e-3;
    NeedleLimits limits;
    const std::atomic<bool>* stop = nullptr;  // ends the replay early, keeping what was written
};

struct ReplayResult {
    std::filesystem::path events;
    std::uint64_t samples = 0;
    std::uint64_t transitions = 0;
    double duration_s = 0;
    double force_peak_N = 0;  // greatest magnitude of the total force
    bool complete = true;
};

// Throws Error: usage (scene, solver), data (needle), run failed (output).
//
// out:    time_s,position_needle_m,position_tissue_m,velocity_tissue_m_per_s,tissue_phase,force_tissue_N,
//         force_fixture_N,force_total_N; one line per sample, numbers with 17 significant digits, so that they
//         read back to the same bits. The surface is the outermost; without tissue nan and "none". The forces
//         are sums over all layers and fixtures.
// events: time_s,element,phase; one line per transition, in the order of time.
ReplayResult replay(const ReplayOptions& options);

}  // namespace thimble
