// `thimble play --replay`: thimble-visual alone, and a recorded trial.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "common/network_settings.hpp"
#include "session/play/play_starter.hpp"

namespace thimble {

struct ReplayPlayOptions {
    std::shared_ptr<PlayStarter> starter;
    NetworkSettings network;
    std::filesystem::path folder;
    std::size_t trial = 1;
    double speed = 1;
    double contact_hold_s = 5;
    Duration longest = Duration::max();
    const std::atomic<bool>* stop = nullptr;
};

// At its end the replay stands still until the user closes the window or quits. Throws Error as find_recorded_trial() and play() do.
void play_recorded(const ReplayPlayOptions& options);

}  // namespace thimble
