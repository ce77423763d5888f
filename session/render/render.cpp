#include "session/render/render.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/process/child.hpp"
#include "session/records/condition_summary.hpp"
#include "session/render/rendered_scenes.hpp"
#include "visual_node/window/captions.hpp"
#include "visual_node/window/image.hpp"
#include "visual_node/window/scene_painter.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

void refuse_to_overwrite(const RenderPlan& plan) {
    std::error_code absent;
    for (const fs::path& file : {frame_file(plan.frames, 0), plan.video.value_or("")}) {
        if (plan.overwrite || file.empty() || !fs::exists(file, absent)) continue;
        throw Error(ExitCode::kUsage, "{} already exists: name another place, or add --overwrite",
                    file.string());
    }
}

// Frames of a longer video must not follow those of this one.
void prepare(const RenderPlan& plan) {
    refuse_to_overwrite(plan);
    std::error_code failure;
    fs::create_directories(plan.frames, failure);
    if (failure) {
        throw Error(ExitCode::kData, "cannot make the folder {}: {}", plan.frames.string(),
                    failure.message());
    }
    for (std::size_t i = 0; fs::remove(frame_file(plan.frames, i), failure); ++i) {
    }
}

class Studio {
  public:
    Studio(const RenderPlan& plan, std::string title)
        : window_({.title = "Thimble",
                   .width = plan.width,
                   .height = plan.height,
                   .visible = false,
                   .vsync = false,
                   .content_scale = 1}),
          gui_(window_),
          title_(std::move(title)) {}

    Image shoot(const std::optional<Scene>& scene, double time_s) {
        window_.poll_events();
        window_.begin_frame(colours::kBackground);
        if (scene) painter_.paint(*scene, {window_.width(), window_.height(), 1}, window_.width());
        gui_.begin();
        if (scene) painter_.draw_over(*scene);
        draw_title(fmt::format("{}   {:6.2f} s", title_, time_s));
        gui_.end();
        Image image = window_.read_pixels();
        window_.end_frame();
        return image;
    }

  private:
    void draw_title(const std::string& title) const {
        if (painter_.cutaway()) return draw_headline(title, *painter_.cutaway());
        draw_notice(title, window_.width());
    }

    GlWindow window_;
    GuiLayer gui_;
    ScenePainter painter_;
    std::string title_;
};

void make_video(const RenderPlan& plan) {
    const auto file = fs::absolute(*plan.video);
    // yuv420p: what every player knows.
    const ProgramResult result =
        run_program("ffmpeg",
                    {"-y", "-loglevel", "error", "-framerate", fmt::format("{:g}", plan.frames_per_s), "-i",
                     "frame_%06d.png", "-pix_fmt", "yuv420p", file.string()},
                    plan.frames, "install ffmpeg to get a video; the frames are kept");
    if (result.exit_code == 0) return;
    throw Error(ExitCode::kRunFailed, "ffmpeg made no {}: {}; the frames are in {}", file.string(),
                result.output, plan.frames.string());
}

}  // namespace

RenderResult render_trial(const RecordedTrial& trial, const RenderPlan& plan) {
    const TrialConditions& conditions = trial.record.conditions;
    Studio studio(plan, fmt::format("{} {}", to_string(conditions.modality), delay_text(conditions.delay_s)));
    prepare(plan);
    RenderedScenes scenes(trial, plan.visual);
    const std::size_t all = frame_count(scenes.duration_s(), plan.frames_per_s);
    RenderResult result;
    for (; result.frames < all; ++result.frames) {
        if (plan.stop != nullptr && *plan.stop) {
            result.complete = false;
            return result;
        }
        const double time_s = static_cast<double>(result.frames) / plan.frames_per_s;
        write_png(frame_file(plan.frames, result.frames), studio.shoot(scenes.at(time_s), time_s));
        if (plan.progress) plan.progress(result.frames + 1, all);
    }
    if (plan.video) make_video(plan);
    return result;
}

}  // namespace thimble
