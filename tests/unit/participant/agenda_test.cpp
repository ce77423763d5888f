// The next step, from the files.
#include "session/participant/agenda.hpp"

#include <gtest/gtest.h>

#include "tests/unit/participant/short_sessions.hpp"

namespace thimble {
namespace {

class AgendaTest : public testing::Test {
  protected:
    AgendaTest() : settings_(*short_settings().protocol) {
        agenda_.order = plan_order(short_settings(), 1);  // practice | 2, 3 | 4, 5
        agenda_.participant = 1;
    }

    void did(std::uint32_t position, EndReason reason = EndReason::kCompleted) {
        const auto next = agenda_.next(settings_);
        ASSERT_TRUE(next.has_value());
        ASSERT_EQ(next->entry.position, position);
        const auto number = static_cast<std::uint32_t>(agenda_.records.size() + 1);
        agenda_.records.push_back(record_of(next->entry, number, reason, next->repeat_of));
    }
    void mark_last(ExclusionKind kind, const std::string& reason) {
        const DatasetRecord& last = agenda_.records.back();
        agenda_.exclusions.push_back({1, last.position, last.record, kind, reason});
    }

    Agenda agenda_;
    ProtocolSettings settings_;
};

TEST_F(AgendaTest, TheOrderIfNothingHappens) {
    for (std::uint32_t position = 1; position <= 5; ++position) did(position);
    EXPECT_FALSE(agenda_.next(settings_).has_value());
    EXPECT_EQ(agenda_.begun(), 5U);
}

TEST_F(AgendaTest, ARejectedTrialComesAgainAtTheEndOfItsBlock) {
    did(1);
    did(2);
    mark_last(ExclusionKind::kRejected, "sneezed");
    did(3);
    const auto step = agenda_.next(settings_);
    ASSERT_TRUE(step.has_value());
    EXPECT_EQ(step->repeat_of, 2U);
    EXPECT_EQ(step->reason, "sneezed");
    did(2);
    did(4);
}

TEST_F(AgendaTest, OrAtOnce) {
    settings_.repeat = RepeatWhen::kAtOnce;
    did(1);
    did(2);
    mark_last(ExclusionKind::kRejected, "sneezed");
    did(2);
    did(3);
}

TEST_F(AgendaTest, AlsoTheLastOfAll) {
    for (std::uint32_t position = 1; position <= 5; ++position) did(position);
    mark_last(ExclusionKind::kRejected, "slipped");
    did(5);
    EXPECT_FALSE(agenda_.next(settings_).has_value());
}

TEST_F(AgendaTest, FailuresAreRepeatedSoOften) {
    settings_.repeats_limit = 2;
    did(1);
    did(2, EndReason::kTimeout);
    did(3);
    did(2, EndReason::kPeerLost);
    did(2, EndReason::kTimeout);
    did(4);  // given up
}

TEST_F(AgendaTest, ATimeoutMayBeAResult) {
    settings_.repeat_timeouts = false;
    did(1);
    did(2, EndReason::kTimeout);
    did(3);
    did(4);
}

TEST_F(AgendaTest, PracticeMayTimeOut) {
    did(1, EndReason::kTimeout);
    did(2);
}

TEST_F(AgendaTest, WhatWasInterruptedIsAlwaysRepeated) {
    settings_.repeats_limit = 0;
    did(1, EndReason::kInterrupted);
    did(1);
    did(2, EndReason::kInterrupted);
    did(3);
    did(2, EndReason::kInterrupted);
    did(2);
    did(4);
}

TEST_F(AgendaTest, WhatIsExcludedIsNotRepeated) {
    did(1);
    did(2, EndReason::kTimeout);
    mark_last(ExclusionKind::kExcluded, "asleep");
    did(3);
    mark_last(ExclusionKind::kRejected, "noise");
    mark_last(ExclusionKind::kExcluded, "enough");
    did(4);
}

TEST_F(AgendaTest, TheMarksOfOthersDoNotMatter) {
    did(1);
    did(2);
    agenda_.exclusions.push_back({2, 2, 2, ExclusionKind::kRejected, "somebody else's"});
    did(3);
    did(4);
}

}  // namespace
}  // namespace thimble
