// Nothing in the loop allocates, in any node, once the first trial has started.
#include <gtest/gtest.h>

#include "tests/allocation_count.hpp"
#include "tests/scenario/rig.hpp"
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
    run_until(session, SessionTime{seconds{1}});
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
    ASSERT_EQ(session.run(trial_of(GetParam().modality, GetParam().delay)).reason, EndReason::kCompleted);
    session.start(trial_of(GetParam().modality, GetParam().delay, 1, 2));
    const std::uint64_t before = allocation_count();
    run_until(session, session.loop().now() + seconds{2});
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
