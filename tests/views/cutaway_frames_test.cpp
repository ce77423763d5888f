// The contract of the cut-away view: HF's oscillation at 50 ms is seen in any two frames 100 ms apart, and CF's hold stands still.
#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

#include "session/render/render.hpp"
#include "session/settings/protocol.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/views/pixels.hpp"
#include "tests/window/virtual_screen.hpp"

namespace thimble {
namespace {

constexpr int kCaption_px = 48;  // condition and time stand above

TrialRecord paper_trial(Modality modality) {
    SystemSettings settings;
    set_delay(settings.netem.force, settings.netem.force_timeline, std::chrono::milliseconds{50});
    const Protocol protocol = experiment_3(settings, 1, 1);
    return run_virtual_trial(settings, {protocol.seed, protocol.experiment, 1, 3, modality, 0.05,
                                        draw_fixture_position_m(protocol, 1, 3)});
}

// The first sample, for the surface at rest, and then those of `length_s` from `begin_s` on.
RecordedTrial part_of(TrialRecord record, double begin_s, double length_s) {
    auto& samples = record.samples;
    const auto outside = [&](const TrajectorySample& s) {
        return s.time_s < begin_s || s.time_s > begin_s + length_s;
    };
    samples.erase(std::remove_if(samples.begin() + 1, samples.end(), outside), samples.end());
    for (auto sample = samples.begin() + 1; sample != samples.end(); ++sample)
        sample->time_s -= begin_s - 0.001;
    return {std::move(record), {}};
}

class CutawayFrames : public OnAScreen {
  protected:
    // Percent of the scene that differs between each frame and the next, 100 ms later.
    std::vector<double> changes(const RecordedTrial& trial, bool cut_away) const {
        RenderPlan plan;
        plan.frames = folder_ / (cut_away ? "cutaway" : "subject");
        plan.frames_per_s = 10;
        plan.overwrite = true;
        plan.visual.cut_away = cut_away;
        const std::size_t count = render_trial(trial, plan).frames;
        std::vector<double> percents;
        for (std::size_t i = 2; i < count; ++i) {
            const Image before = read_png(frame_file(plan.frames, i - 1)),
                        now = read_png(frame_file(plan.frames, i));
            const Rect scene{0, kCaption_px, static_cast<double>(now.width),
                             static_cast<double>(now.height) - kCaption_px};
            percents.push_back(100.0 * count_different(before, now, scene) / (scene.width * scene.height));
        }
        return percents;
    }

    Folder folder_;
};

TEST_F(CutawayFrames, ShowHFShakeAndCFHoldStill) {
    const TrialRecord hf = paper_trial(Modality::kHF), cf = paper_trial(Modality::kCF);
    const double fixture_m = hf.conditions.fixture_position_m;
    const auto reached = std::find_if(hf.samples.begin(), hf.samples.end(), [&](const TrajectorySample& s) {
        return s.position_needle_m > fixture_m;
    });
    ASSERT_NE(reached, hf.samples.end());
    const RecordedTrial shaking = part_of(hf, reached->time_s, 0.9);
    const std::vector<double> shown = changes(shaking, true), hidden = changes(shaking, false);
    ASSERT_GT(shown.size(), 5U);
    for (const double percent : shown) EXPECT_GT(percent, 1.0);
    ASSERT_GT(cf.beep_time_s, 4);
    const std::vector<double> held = changes(part_of(cf, cf.beep_time_s - 2, 1.5), true);
    ASSERT_GT(held.size(), 10U);
    for (const double percent : held) EXPECT_LT(percent, 0.1);
    // The paper's screen hides what happens inside.
    ASSERT_GT(hidden.size(), 5U);
    for (const double percent : hidden) EXPECT_LT(percent, 1.0);
}

}  // namespace
}  // namespace thimble
