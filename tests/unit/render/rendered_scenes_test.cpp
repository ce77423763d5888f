// A video shows the scenes of the screen: late by the delay, the bar in VF only, the needle to the surface.
#include "session/render/rendered_scenes.hpp"

#include <gtest/gtest.h>

#include "session/render/render.hpp"

namespace thimble {
namespace {

// 2 s at 1 kHz: the needle moves 20 mm/s from -10 mm, meets the surface at rest at 0, the force grows with the way.
std::vector<TrajectorySample> pushed_in() {
    std::vector<TrajectorySample> samples(2001);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        TrajectorySample& sample = samples[i];
        sample.time_s = static_cast<double>(i) * 1e-3;
        sample.position_needle_m = -0.01 + 0.02 * sample.time_s;
        sample.force_total_N = sample.position_needle_m > 0 ? -200 * sample.position_needle_m : 0;
        sample.phase = sample.position_needle_m > 0 ? TissuePhase::kPenetrated : TissuePhase::kFree;
    }
    return samples;
}

RecordedTrial trial_with(Modality modality, double delay_s) {
    RecordedTrial trial;
    trial.record.samples = pushed_in();
    trial.record.conditions.modality = modality;
    trial.record.conditions.delay_s = delay_s;
    return trial;
}

TEST(RenderedScenes, ShowWhatHasArrived) {
    const RecordedTrial undelayed = trial_with(Modality::kHF, 0), delayed = trial_with(Modality::kHF, 0.2);
    RenderedScenes now(undelayed, {}), later(delayed, {.picture_delayed = true});
    EXPECT_FALSE(later.at(0.1));
    for (const double time_s : {0.3, 0.31, 0.45}) {
        EXPECT_DOUBLE_EQ(now.at(time_s)->position_needle_m, -0.01 + 0.02 * time_s);
        EXPECT_NEAR(later.at(time_s)->position_needle_m, -0.01 + 0.02 * (time_s - 0.2), 2.1e-5);
    }
    EXPECT_DOUBLE_EQ(now.duration_s(), 2);
    EXPECT_DOUBLE_EQ(later.duration_s(), 2.2);
}

TEST(RenderedScenes, ShowThePictureAtOnceAndTheBarLater) {
    const RecordedTrial delayed = trial_with(Modality::kVF, 0.2);
    RenderedScenes scenes(delayed, {});
    EXPECT_DOUBLE_EQ(scenes.at(0.1)->position_needle_m, -0.01 + 0.02 * 0.1);
    EXPECT_EQ(scenes.at(0.1)->bar_N, 0);
    EXPECT_NEAR(scenes.at(1.5)->bar_N, 200 * (0.02 * 1.3 - 0.01), 0.031);
}

TEST(RenderedScenes, HideTheInsertedNeedle) {
    const RecordedTrial trial = trial_with(Modality::kHF, 0);
    RenderedScenes scenes(trial, {});
    EXPECT_DOUBLE_EQ(scenes.at(1.5)->position_needle_m, 0);
    EXPECT_TRUE(scenes.at(1.5)->touching);
}

TEST(RenderedScenes, ShowTheForceAsItsModalityDoes) {
    const RecordedTrial trials[] = {trial_with(Modality::kVF, 0), trial_with(Modality::kHF, 0),
                                    trial_with(Modality::kCF, 0)};
    RenderedScenes vf(trials[0], {}), hf(trials[1], {}), cf(trials[2], {});
    EXPECT_NEAR(vf.at(1.5)->bar_N, 4, 0.031);  // in steps of a pixel
    EXPECT_TRUE(vf.at(1.5)->bar_shown);
    EXPECT_EQ(hf.at(1.5)->bar_N, 0);
    EXPECT_FALSE(hf.at(1.5)->bar_shown);
    EXPECT_TRUE(cf.at(1.5)->fingertip_shown);
    EXPECT_FALSE(hf.at(1.5)->fingertip_shown);
}

TEST(RenderedScenes, ADelayThatFallsMakesNobodyOvertake) {
    RecordedTrial trial = trial_with(Modality::kHF, 0.5);
    trial.record.network_events.push_back({1.0, 0.0});
    RenderedScenes scenes(trial, {.picture_delayed = true});
    EXPECT_NEAR(scenes.at(0.9)->position_needle_m, -0.01 + 0.02 * 0.4, 2.1e-5);
    // Samples sent before 1.0 s arrive until 1.5 s. Later ones arrive all at once after it.
    EXPECT_NEAR(scenes.at(1.498)->position_needle_m, 0, 1e-12);
    const SessionTime earlier = scenes.at(1.55)->sample_time;  // asked first: times must not fall
    EXPECT_NEAR(to_seconds(scenes.at(1.6)->sample_time - earlier), 0.05, 0.0011);
    EXPECT_DOUBLE_EQ(scenes.duration_s(), 2);
}

TEST(RenderedFrames, OneAtTheStartAndOnePerPeriod) {
    EXPECT_EQ(frame_count(0, 30), 1U);
    EXPECT_EQ(frame_count(1, 30), 31U);
    EXPECT_EQ(frame_count(2.2, 10), 23U);  // 2.2 x 10 is 22 but for rounding
    EXPECT_EQ(frame_count(0.099, 10), 1U);
    EXPECT_EQ(frame_file("f", 12).string(), "f/frame_000012.png");
}

}  // namespace
}  // namespace thimble
