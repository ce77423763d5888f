// Nothing in the loop allocates, in any node, once the first trial has started.
#include <gtest/gtest.h>

#include "session/virtual/virtual_session.hpp"
#include "tests/allocation_count.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::seconds;

struct Case {
    Modality modality;
    Duration delay;
};

class Allocations : public testing::TestWithParam<Case> {};

TEST_P(Allocations, NoneFromTheFirstSecondToTheEndOfTheTrial) {
    VirtualSession session(paper_with_delays({}, GetParam().delay));
    session.start(trial_of(GetParam().modality, GetParam().delay));
    while (session.loop().now() < SessionTime{seconds{1}} && session.step()) {
    }
    const std::size_t samples = session.session().record().samples.size();
    const std::uint64_t before = allocation_count();
    while (session.step()) {
    }
    EXPECT_EQ(allocation_count() - before, 0U);
    ASSERT_EQ(session.session().record().reason, EndReason::kCompleted);
    EXPECT_GT(session.session().record().samples.size(), samples + 5000);
}

TEST_P(Allocations, NoneInTheSecondTrialOfASession) {
    VirtualSession session(paper_with_delays({}, GetParam().delay));
    const TrialConditions first = trial_of(GetParam().modality, GetParam().delay, 1, 1);
    const TrialConditions second = trial_of(GetParam().modality, GetParam().delay, 1, 2);
    ASSERT_EQ(session.run(first).reason, EndReason::kCompleted);
    session.start(second);
    const std::uint64_t before = allocation_count();
    const SessionTime end = session.loop().now() + seconds{2};
    while (session.loop().now() < end && session.step()) {
    }
    EXPECT_EQ(allocation_count() - before, 0U);
}

INSTANTIATE_TEST_SUITE_P(InEachModality, Allocations,
                         testing::Values(Case{Modality::kHF, {}}, Case{Modality::kCF, {}},
                                         Case{Modality::kCCF, {}}, Case{Modality::kVF, {}},
                                         Case{Modality::kHF, kPaperDelay}, Case{Modality::kVF, kPaperDelay}),
                         [](const auto& test) {
                             return std::string(to_string(test.param.modality)) +
                                    (test.param.delay == kPaperDelay ? "At50ms" : "WithoutDelay");
                         });

// A counter that does not count would prove nothing.
TEST(AllocationCount, CountsPlainAndAlignedMemory) {
    const std::uint64_t before = allocation_count();
    const VirtualSession session(paper());
    EXPECT_GT(allocation_count() - before, 10U);
    struct alignas(64) Wide {
        char bytes[64];
    };
    const std::uint64_t plain = allocation_count();
    const auto wide = std::make_unique<Wide>();
    EXPECT_EQ(allocation_count() - plain, 1U) << &wide;
}

}  // namespace
}  // namespace thimble::test
