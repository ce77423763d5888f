#include "session/render/rendered_scenes.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "session/render/render.hpp"

namespace thimble {

namespace {

// Faster than any video, so that a scene is always due.
constexpr double kScenes_Hz = 1000;
// Starts later than time zero, which means "never" in some nodes.
constexpr SessionTime kBegin = from_nanoseconds(1'000'000'000);

VisualSettings for_videos(VisualSettings settings) {
    settings.refresh_Hz = kScenes_Hz;
    settings.fingertip = true;  // a video's viewer wears no device
    return settings;
}

}  // namespace

RenderedScenes::RenderedScenes(const RecordedTrial& trial, VisualSettings settings)
    : trial_(&trial), picture_delayed_(settings.picture_delayed), node_(for_videos(std::move(settings))) {
    assert(!trial.record.samples.empty());
    const TrialConditions& conditions = trial.record.conditions;
    node_.start_trial(kBegin, start_order(conditions), conditions.trial);
}

double RenderedScenes::duration_s() const {
    const TrajectorySample& last = trial_->record.samples.back();
    return last.time_s + trial_->delay_s(last.time_s);
}

double RenderedScenes::force_arrival_s(const TrajectorySample& sample) const {
    return std::max(sample.time_s + trial_->delay_s(sample.time_s), newest_s_);
}

template <class Arrival, class Use>
void RenderedScenes::arrive(double time_s, std::size_t& next, const Arrival& arrival_s, const Use& use) {
    const auto& samples = trial_->record.samples;
    for (; next < samples.size() && arrival_s(samples[next]) <= time_s; ++next) {
        const double arrived_s = arrival_s(samples[next]);
        use(kBegin + from_seconds(arrived_s), trial_->feedback(samples[next]));
    }
}

std::optional<Scene> RenderedScenes::at(double time_s) {
    const auto with_force = [&](const TrajectorySample& sample) { return force_arrival_s(sample); };
    const auto at_once = [](const TrajectorySample& sample) { return sample.time_s; };
    arrive(time_s, next_force_, with_force, [&](SessionTime when, const ForceFeedback& feedback) {
        newest_s_ = to_seconds(when - kBegin);
        node_.on_force(when, feedback);
        if (picture_delayed_) node_.on_picture(when, feedback);
    });
    if (!picture_delayed_) {
        arrive(time_s, next_picture_, at_once,
               [&](SessionTime when, const ForceFeedback& feedback) { node_.on_picture(when, feedback); });
    }
    // A millisecond on: the first scene is due within the first one.
    const SessionTime now = kBegin + from_seconds(std::max(time_s, 1 / kScenes_Hz));
    if (const auto scene = node_.frame(now)) newest_ = scene;
    return newest_;
}

std::size_t frame_count(double duration_s, double frames_per_s) {
    // A duration that is a whole number of periods, but for rounding, has its last frame.
    return static_cast<std::size_t>(std::floor(duration_s * frames_per_s + 1e-9)) + 1;
}

std::filesystem::path frame_file(const std::filesystem::path& folder, std::size_t frame) {
    return folder / fmt::format("frame_{:06}.png", frame);
}

}  // namespace thimble
