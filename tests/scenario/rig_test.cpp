// The other tests' findings in the rig hold for the real session only if the two are the same.
#include "tests/scenario/rig.hpp"

#include <gtest/gtest.h>

#include "session/virtual/virtual_session.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

TEST(Rig, GivesTheBitsOfAVirtualSession) {
    for (const Modality modality : {Modality::kHF, Modality::kCF, Modality::kVF}) {
        const TrialConditions trial = trial_of(modality, kPaperDelay);
        const TrialRecord expected = run_virtual_trial(paper(), trial);
        Rig rig(paper_with_delays({}, kPaperDelay));
        const TrialRecord& record = rig.run(trial);
        EXPECT_TRUE(same_samples(record, expected)) << to_string(modality);
        EXPECT_EQ(record.beep_time_s, expected.beep_time_s);
        EXPECT_EQ(record.round_trip_s, expected.round_trip_s);
        EXPECT_EQ(record.reason, expected.reason);
    }
}

TEST(Rig, TapsThatDoNothingChangeNothing) {
    const TrialConditions trial = trial_of(Modality::kHF, kPaperDelay);
    const SystemSettings settings = paper_with_delays({}, kPaperDelay);
    int taps = 0;
    Rig tapped(settings, [&](Wire, Channel& end) {
        ++taps;
        return std::make_unique<Tap>(end);
    });
    Rig plain(settings);
    EXPECT_TRUE(same_samples(tapped.run(trial), plain.run(trial)));
    EXPECT_EQ(taps, 18);
}

}  // namespace
}  // namespace thimble::test
