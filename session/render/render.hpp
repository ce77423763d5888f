// A recorded trial as pictures, one file per frame, and as a video where ffmpeg is installed. The window's own
// painter draws it in a hidden window, so it looks as it did.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>

#include "session/play/recorded_trial.hpp"
#include "visual_node/visual_settings.hpp"

namespace thimble {

struct RenderPlan {
    std::filesystem::path frames;                // folder for frame_000000.png ..., made if it is missing
    std::optional<std::filesystem::path> video;  // by ffmpeg, in the format that its name asks for
    double frames_per_s = 30;                    // of the trial's time
    int width = 800, height = 600;
    bool overwrite = false;  // of frames and video that are there
    VisualSettings visual;
    const std::atomic<bool>* stop = nullptr;
    std::function<void(std::size_t done, std::size_t all)> progress;  // may be empty
};

struct RenderResult {
    std::size_t frames = 0;
    bool complete = true;  // false: stopped; the frames done are kept
};

// How many frames a trial of that length has: one at its start, then one per period.
std::size_t frame_count(double duration_s, double frames_per_s);
std::filesystem::path frame_file(const std::filesystem::path& folder, std::size_t frame);

// Throws Error: usage, if there are frames or a video already, or no screen (xvfb-run makes one) to draw on; data, if a
// file cannot be written; run failed, with ffmpeg's words.
RenderResult render_trial(const RecordedTrial& trial, const RenderPlan& plan);

}  // namespace thimble
