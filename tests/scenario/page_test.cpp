// The page in the browser without the browser: a visitor's pointer, frame by frame, and the study that the page runs.
#include <gmock/gmock.h>

#include "browser/live_trial.hpp"
#include "browser/page_study.hpp"
#include "study/study.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

constexpr double kFrame_s = 1 / 60.0;
constexpr double kPerNeedle = 1 / kPositionScale;

LiveChoice choice(Modality modality, double delay_s = 0.05) {
    LiveChoice made;
    made.modality = modality;
    made.delay_s = delay_s;
    return made;
}

void run_frames(LiveTrial& trial, int frames) {
    for (; frames > 0; --frames) trial.advance(kFrame_s);
}

// Drags the needle to `depth_m` at 90 mm/s and holds it there until `end_s`.
LiveState drag(LiveTrial& trial, double depth_m, double end_s) {
    for (double time_s = 0; time_s < end_s; time_s += kFrame_s) {
        trial.point(kPerNeedle * std::min(depth_m, 0.09 * time_s), true);
        trial.advance(kFrame_s);
    }
    return trial.state();
}

TEST(LiveTrial, TheForceInTheHandShakesAtFiftyMilliseconds) {
    LiveTrial trial(choice(Modality::kHF));
    const LiveState state = drag(trial, 0.125, 6);
    EXPECT_GE(state.contacts_lost, 4);
    EXPECT_GE(state.frequency_Hz, 1);
    EXPECT_LT(state.energy_in_J, -0.1);
}

TEST(LiveTrial, TheForceOnTheFingertipDoesNot) {
    for (const Modality modality : {Modality::kCF, Modality::kCCF, Modality::kVF}) {
        LiveTrial trial(choice(modality));
        const LiveState state = drag(trial, 0.125, 6);
        EXPECT_EQ(state.contacts_lost, 0) << to_string(modality);
        EXPECT_GT(state.hold_s, 3) << to_string(modality);
    }
}

TEST(LiveTrial, WithoutDelayTheHandRestsAtTheWall) {
    LiveTrial trial(choice(Modality::kHF, 0));
    EXPECT_LE(drag(trial, 0.125, 6).contacts_lost, 2);
}

// A wall and a pointer's spring that are both at their limit would have no stiffness together, and so no instability.
TEST(LiveTrial, ShovingDoesNotCureIt) {
    LiveTrial trial(choice(Modality::kHF));
    EXPECT_GE(drag(trial, 0.195, 8).frequency_Hz, 1);
}

TEST(LiveTrial, ALaterDelayActsAtOnce) {
    LiveTrial trial(choice(Modality::kHF, 0));
    const double before = drag(trial, 0.125, 4).contacts_lost;
    trial.change_delay(0.05);
    trial.point(kPerNeedle * 0.08, true);
    trial.advance(0.2);
    trial.point(kPerNeedle * 0.125, true);
    run_frames(trial, 240);
    EXPECT_GE(trial.state().contacts_lost, before + 4);
}

TEST(LiveTrial, AfterTheBeepAndTheWayOutTheNextTrialBegins) {
    LiveTrial trial(choice(Modality::kCF));
    EXPECT_EQ(drag(trial, 0.125, 9).beeps, 1);
    for (int frame = 0; frame < 180; ++frame) {
        trial.point(0, true);
        trial.advance(kFrame_s);
    }
    EXPECT_EQ(trial.state().trials, 1);
    EXPECT_EQ(trial.state().contacts_lost, 0);
    EXPECT_EQ(trial.state().beeps, 0);
}

TEST(LiveTrial, LetGoTheNeedleRests) {
    LiveTrial trial(choice(Modality::kHF));
    drag(trial, 0.05, 2);
    trial.point(0, false);
    run_frames(trial, 60);
    const double place_m = trial.state().needle_m;
    run_frames(trial, 60);
    EXPECT_NEAR(trial.state().needle_m, place_m, 1e-3);
}

TEST(LiveTrial, TheVirtualSubjectDoesAllByItself) {
    LiveChoice by_itself = choice(Modality::kCF);
    by_itself.virtual_hand = true;
    LiveTrial trial(by_itself);
    run_frames(trial, 60 * 30);
    EXPECT_GE(trial.state().trials, 1);
}

TEST(LiveTrial, NetworksHaveNames) {
    LiveTrial trial(choice(Modality::kHF));
    EXPECT_DOUBLE_EQ(trial.state().delay_s, 0.05);
    EXPECT_TRUE(trial.change_network("geo"));
    EXPECT_DOUBLE_EQ(trial.state().delay_s, 0.3);
    EXPECT_FALSE(trial.change_network("starlight"));
}

TEST(LiveTrial, ThePictureHasTheNeedleAndTheWall) {
    LiveTrial trial(choice(Modality::kHF));
    drag(trial, 0.05, 2);
    const Scene scene = trial.scene();
    ASSERT_TRUE(scene.cut_away);
    EXPECT_NEAR(scene.cut_away->position_needle_m, 0.05, 0.01);
    EXPECT_EQ(scene.cut_away->position_fixture_m, trial.state().fixture_m);
}

TEST(LiveTrial, ThePictureKnowsWhereTheSkinRestsBeforeTheFirstFrame) {
    LiveTrial trial(choice(Modality::kHF));
    for (int ms = 0; ms < 100 && !trial.scene().cut_away; ++ms) trial.advance(0.001);
    ASSERT_TRUE(trial.scene().cut_away);
    EXPECT_NEAR(trial.scene().position_surface_rest_m, 0.02, 1e-3);
}

// The page's promise: the bytes of the native study, whatever the slices.
TEST(PageStudy, WritesTheTableOfTheStudy) {
    PageStudy study(1, 1);
    unsigned slice = 1;
    while (study.go_on(slice)) slice = slice % 977 + 100;
    const TemporaryDirectory folder;
    study.write_table(folder / "trials.csv");
    TrialTable native(folder / "expected.csv");
    const SystemSettings settings = load_system_settings({});
    const auto append = [&](const TrialRecord& record) { native.append(make_row(record)); };
    EXPECT_TRUE(run_trials(settings, all_trials({experiment_3(settings, 1, 1)}), 1, nullptr, append));
    EXPECT_EQ(read_text(folder / "trials.csv"), read_text(folder / "expected.csv"));
    EXPECT_EQ(study.rows().size(), study.planned());
}

}  // namespace
}  // namespace thimble
