// `thimble play`: five nodes on this machine, a person at the pointer, trial after trial until the player ends it.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "common/network_settings.hpp"
#include "session/play/play_starter.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

struct PlayOptions {
    std::shared_ptr<PlayStarter> starter;
    NetworkSettings network;
    Modality modality = Modality::kHF;
    double delay_s = 0.05;         // at the start, of the force path
    std::filesystem::path record;  // folder for trials.csv, trajectories/ and nodes/; empty: nothing is kept
    Duration longest = Duration::max();
    const std::atomic<bool>* stop = nullptr;
};

struct PlayResult {
    std::uint32_t trials = 0;
};

// Longer than a played trial.
inline constexpr Duration kPlayTimeout = std::chrono::minutes{30};

// Ends when the window is closed, at a Quit, at a stop, or after `longest`. Throws Error (usage) if the record's folder holds a
// table already. Throws Error (network) if a port is taken, or a node ends by itself, with its words. Throws Error (run failed) if
// a file cannot be written.
PlayResult play(const SystemSettings& settings, const PlayOptions& options);

}  // namespace thimble
