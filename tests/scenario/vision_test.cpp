// The operator never sees the inserted part of the needle nor the fixture, and a bar only in VF.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenario/rig.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

struct Shown {
    SessionTime when;
    Percept percept;
};

using ShownList = std::vector<Shown>;

class Watcher final : public Tap {
  public:
    Watcher(Channel& end, ShownList& target) : Tap(end), list_(&target) {}
    void send(Bytes datagram) override {
        const Decoded decoded = decode(datagram);
        ASSERT_TRUE(decoded.message);
        list_->push_back({decoded.message->header.send_time, std::get<Percept>(decoded.message->body)});
        Tap::send(datagram);
    }

  private:
    ShownList* list_;
};

TEST(Vision, TheInsertedPartIsNeverShown) {
    for (const Modality modality : kModalities) {
        ShownList all_shown;
        Rig rig(paper(), tap_on<Watcher>({Wire::kPerceptVisual}, all_shown));
        const TrialRecord& record = rig.run(trial_of(modality));
        ASSERT_EQ(record.reason, EndReason::kCompleted);
        double deepest_m = 0, deepest_shown_m = -1;
        for (const TrajectorySample& s : record.samples) {
            deepest_m = std::max(deepest_m, s.position_needle_m - s.position_surface_m);
        }
        ASSERT_GT(deepest_m, 0.05);  // there was something to hide
        int hidden = 0;
        for (const Shown& shown : all_shown) {
            const Percept& p = shown.percept;
            deepest_shown_m =
                std::max(deepest_shown_m, p.position_needle_shown_m - p.position_surface_shown_m);
            hidden += p.touching_shown && p.position_needle_shown_m == p.position_surface_shown_m;
            EXPECT_EQ(p.force_N, 0);
            if (modality != Modality::kVF) {
                EXPECT_EQ(p.bar_N, 0);
            }
        }
        EXPECT_LE(deepest_shown_m, 0);
        EXPECT_GT(hidden, 100);
        // 60 frames a second, and the beep.
        EXPECT_NEAR(static_cast<double>(all_shown.size()), 60 * record.samples.back().time_s, 10);
    }
}

TEST(Vision, TheBarIsShownInVF) {
    ShownList all_shown;
    Rig rig(paper(), tap_on<Watcher>({Wire::kPerceptVisual}, all_shown));
    rig.run(trial_of(Modality::kVF));
    double longest_N = 0;
    for (const Shown& shown : all_shown) longest_N = std::max(longest_N, shown.percept.bar_N);
    EXPECT_GT(longest_N, 5);
    EXPECT_LE(longest_N, 12);
}

// Two trials that differ in nothing but the fixture's place look the same until the needle is at the nearer
// one, even where the hand has been inside for seconds.
TEST(Vision, NothingShownTellsWhereTheFixtureIs) {
    ShownList near_shown, far_shown;
    TrialConditions near = trial_of(Modality::kVF), far = near;
    near.fixture_position_m = 0.110;
    far.fixture_position_m = 0.135;
    Rig near_rig(paper(), tap_on<Watcher>({Wire::kPerceptVisual}, near_shown));
    Rig far_rig(paper(), tap_on<Watcher>({Wire::kPerceptVisual}, far_shown));
    const TrialRecord& record = near_rig.run(near);
    far_rig.run(far);
    double touched_s = 0;
    for (const TrajectorySample& s : record.samples) {
        if (s.contact_time_s > 0 || s.force_fixture_N != 0) break;
        touched_s = s.time_s;
    }
    ASSERT_GT(touched_s, 3);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < near_shown.size() && i < far_shown.size(); ++i) {
        const Shown &a = near_shown[i], &b = far_shown[i];
        if (to_seconds(a.when.time_since_epoch()) > touched_s) break;
        ++compared;
        ASSERT_EQ(a.when, b.when);
        ASSERT_EQ(a.percept.bar_N, b.percept.bar_N);
        ASSERT_EQ(a.percept.position_needle_shown_m, b.percept.position_needle_shown_m);
        ASSERT_EQ(a.percept.position_surface_shown_m, b.percept.position_surface_shown_m);
        ASSERT_EQ(a.percept.touching_shown, b.percept.touching_shown);
    }
    EXPECT_GT(compared, 150U);
}

}  // namespace
}  // namespace thimble::test
