#include "thimble/commands/render_options.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/process/progress.hpp"
#include "session/render/render.hpp"

namespace thimble {

void add_render_options(CLI::App& play, CLI::Option* replay, RenderArguments& a) {
    const auto group = "Pictures of a replay";
    play.add_option("--frames", a.frames, "folder for one PNG file per frame; nothing is shown")
        ->needs(replay)
        ->group(group);
    play.add_option("--video", a.video, "a video by ffmpeg, e.g. trial.mp4; frames beside it unless --frames")
        ->needs(replay)
        ->group(group);
    play.add_option("--frames-per-s", a.frames_per_s, "of the trial's time")
        ->default_val(a.frames_per_s)
        ->check(CLI::Range(1.0, 1000.0))
        ->needs(replay)
        ->group(group);
    play.add_flag("--overwrite", a.overwrite, "replace frames and video that are there")
        ->needs(replay)
        ->group(group);
}

namespace {

RenderResult render_and_show_progress(const RecordedTrial& trial, RenderPlan& plan) {
    Progress progress;
    plan.progress = [&](std::size_t done, std::size_t all) {
        progress.show(fmt::format("frame {} of {}", done, all), done % 100 == 0);
    };
    return render_trial(trial, plan);
}

}  // namespace

int render_and_say(const RecordedTrial& trial, const VisualSettings& visual, const RenderArguments& arguments,
                   const std::atomic<bool>* stop) {
    RenderPlan plan;
    plan.frames = arguments.frames.empty() ? arguments.video + "_frames" : arguments.frames;
    if (!arguments.video.empty()) plan.video = arguments.video;
    plan.frames_per_s = arguments.frames_per_s;
    plan.overwrite = arguments.overwrite;
    plan.visual = visual;
    plan.stop = stop;
    const RenderResult result = render_and_show_progress(trial, plan);
    fmt::print("{} frames: {}{}\n", result.frames, plan.frames.string(),
               plan.video && result.complete ? ", " + plan.video->string() : "");
    if (!result.complete) spdlog::error("interrupted; the {} frames done are kept", result.frames);
    return static_cast<int>(result.complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

}  // namespace thimble
