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

// Protection changes no bit of a trial.
std::shared_ptr<const LabKey> virtual_lab_key() {
    std::array<std::uint8_t, kKeyBytes> bytes{};
    bytes.fill(42);
    return std::make_shared<const LabKey>(bytes);
}

TEST(ProtectedSession, HasTheSameBitsAsAnOpenOne) {
    for (const Modality modality : {Modality::kHF, Modality::kCCF}) {
        TrialConditions conditions;
        conditions.modality = modality;
        conditions.fixture_position_m = 0.035;
        const SystemSettings settings = paper_with_delays({}, kPaperDelay);
        VirtualSession open(settings), secured(settings, virtual_lab_key());
        const TrialRecord& plain = open.run(conditions);
        EXPECT_TRUE(same_samples(secured.run(conditions), plain));
        EXPECT_EQ(plain.reason, EndReason::kCompleted);
        const SecurityCounters counters = secured.network().counters();
        EXPECT_GT(counters.opened, 5000U);
        EXPECT_EQ(counters.handshakes, 10U);  // five, as both sides count them
        EXPECT_EQ(counters.forged + counters.replayed + counters.wrong_role + counters.unsealed +
                      counters.handshake_refused,
                  0U);
        EXPECT_EQ(open.network().counters().opened, 0U);
    }
}

}  // namespace
}  // namespace thimble::test
