// Options of `thimble play --replay` that make pictures of a recorded trial instead of showing it.
#pragma once

#include <atomic>
#include <string>

#include "session/play/recorded_trial.hpp"
#include "visual_node/visual_settings.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
}  // namespace CLI

namespace thimble {

struct RenderArguments {
    std::string frames, video;
    double frames_per_s = 30;
    bool overwrite = false;

    bool asked() const { return !frames.empty() || !video.empty(); }
};

void add_render_options(CLI::App& play, CLI::Option* replay, RenderArguments& arguments);

// Returns the exit code. Throws Error as render_trial() does; usage, if this build has no windows.
int render_and_say(const RecordedTrial& trial, const VisualSettings& visual, const RenderArguments& arguments,
                   const std::atomic<bool>* stop);

}  // namespace thimble
