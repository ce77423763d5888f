// The next step, from the files.
#include "session/participant/agenda.hpp"

#include <functional>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "session/participant/counted_trials.hpp"
#include "session/participant/dataset.hpp"
#include "tests/unit/participant/short_sessions.hpp"

namespace thimble {
namespace {

using testing::Contains;
using testing::HasSubstr;

class AgendaTest : public testing::Test {
  protected:
    AgendaTest() : settings_(*short_settings().protocol) {
        agenda_.order = plan_order(short_settings(), 1);  // practice | 2, 3 | 4, 5
        agenda_.participant = 1;
    }

    // The trials that must come, by their positions. A letter after one says how it ends: Timeout, Lost peer, Interrupted; or how
    // it is marked: Rejected, eXcluded. A full stop: nothing more comes.
    void play(const std::string& script) {
        std::istringstream steps(script);
        for (std::string step; steps >> step;) {
            const auto next = agenda_.next(settings_);
            ASSERT_EQ(next.has_value(), step != ".") << script;
            if (!next) return;
            ASSERT_EQ(next->entry.position, static_cast<std::uint32_t>(step.front() - '0')) << script;
            const auto has = [&](char letter) { return step.find(letter) != std::string::npos; };
            const EndReason reason = has('t')   ? EndReason::kTimeout
                                     : has('l') ? EndReason::kPeerLost
                                     : has('i') ? EndReason::kInterrupted
                                                : EndReason::kCompleted;
            const auto number = static_cast<std::uint32_t>(agenda_.records.size() + 1);
            agenda_.records.push_back(record_of(next->entry, number, reason, next->repeat_of));
            if (has('r')) mark_last(ExclusionKind::kRejected);
            if (has('x')) mark_last(ExclusionKind::kExcluded);
        }
    }
    void mark_last(ExclusionKind kind) {
        const DatasetRecord& last = agenda_.records.back();
        agenda_.exclusions.push_back({1, last.position, last.record, kind, "because"});
    }

    Agenda agenda_;
    ProtocolSettings settings_;
};

TEST_F(AgendaTest, TheOrderIfNothingHappens) {
    play("1 2 3 4 5");
    EXPECT_FALSE(agenda_.next(settings_).has_value());
    EXPECT_EQ(agenda_.begun(), 5U);
}

TEST_F(AgendaTest, ARepeatNamesItsRecordAndReason) {
    play("1 2r 3");
    const auto step = agenda_.next(settings_);
    ASSERT_TRUE(step.has_value());
    EXPECT_EQ(step->repeat_of, 2U);
    EXPECT_EQ(step->reason, "because");
}

TEST_F(AgendaTest, EachScriptIsWhatComes) {
    struct Case {
        const char* why;
        const char* script;
        std::function<void(ProtocolSettings&)> set = [](ProtocolSettings&) {};
    };
    for (const Case& c :
         {Case{"a rejected trial comes again at the end of its block", "1 2r 3 2 4"},
          Case{"or at once", "1 2r 2 3", [](auto& s) { s.repeat = RepeatWhen::kAtOnce; }},
          Case{"also the last of all", "1 2 3 4 5r 5 ."},
          Case{"failures are repeated so often, then given up", "1 2t 3 2l 2t 4",
               [](auto& s) { s.repeats_limit = 2; }},
          Case{"a timeout may be a result", "1 2t 3 4", [](auto& s) { s.repeat_timeouts = false; }},
          Case{"practice may time out", "1t 2"},
          Case{"what was interrupted is always repeated", "1i 1 2i 3 2i 2 4",
               [](auto& s) { s.repeats_limit = 0; }},
          Case{"what is excluded is not repeated", "1 2tx 3rx 4"}}) {
        SCOPED_TRACE(c.why);
        agenda_.records.clear();
        agenda_.exclusions.clear();
        settings_ = *short_settings().protocol;
        c.set(settings_);
        play(c.script);
    }
}

TEST_F(AgendaTest, TheMarksOfOthersDoNotMatter) {
    play("1 2");
    agenda_.exclusions.push_back({2, 2, 2, ExclusionKind::kRejected, "somebody else's"});
    play("3 4");
}

// The trials that an analysis gets, and the report about the others.
class CountedTrialsTest : public testing::Test {
  protected:
    CountedTrialsTest() : dataset_(directory_ / "d"), order_(plan_order(short_settings(), 2)) {
        dataset_.open(SubjectKind::kVirtual, {});
        add_participant(dataset_, 2, SubjectKind::kVirtual, {});
        write_order(dataset_.order(2), order_);
    }
    void did(std::size_t position, EndReason reason = EndReason::kCompleted, std::uint32_t repeat_of = 0) {
        const auto number = static_cast<std::uint32_t>(read_records(dataset_.records(2)).size() + 1);
        RecordTable(dataset_.records(2)).append(record_of(order_[position - 1], number, reason, repeat_of));
    }
    LeftOut why(std::uint32_t record) const {
        for (const LeftOutTrial& trial : counted_trials(dataset_).left_out) {
            if (trial.record == record) return trial.why;
        }
        ADD_FAILURE() << "record " << record << " counts";
        return LeftOut::kPractice;
    }

    TemporaryDirectory directory_;
    Dataset dataset_;
    std::vector<OrderEntry> order_;
};

// As a power cut leaves it where a file system forgets the order and not the participant.
TEST_F(CountedTrialsTest, WhoeverHasNoOrderYetHasNotBegun) {
    did(2);
    add_participant(dataset_, 3, SubjectKind::kVirtual, {});
    const CountedTrials counted = counted_trials(dataset_);
    EXPECT_EQ(counted.participants, 1U);
    EXPECT_EQ(counted.rows.size(), 1U);
    RecordTable(dataset_.records(3)).append(record_of(order_[1], 1));
    EXPECT_THROW(counted_trials(dataset_), Error);  // trials without an order are damage
}

TEST_F(CountedTrialsTest, EveryReason) {
    did(1);                            // 1: practice
    did(2, EndReason::kTimeout);       // 2: superseded by 4
    did(3);                            // 3: rejected, repeated by 5
    did(2, EndReason::kCompleted, 2);  // 4: counts
    did(3, EndReason::kCompleted, 3);  // 5: excluded
    did(4, EndReason::kPeerLost);      // 6: failed
    did(5, EndReason::kTimeout);       // 7: a timeout that is not repeated counts
    add_exclusion(dataset_.exclusions(), {2, 3, 3, ExclusionKind::kRejected, "sneezed"});
    add_exclusion(dataset_.exclusions(), {2, 3, 5, ExclusionKind::kExcluded, "phone rang"});
    const CountedTrials counted = counted_trials(dataset_);
    ASSERT_EQ(counted.rows.size(), 2U);
    EXPECT_EQ(counted.rows[0].conditions.trial, order_[1].conditions.trial);
    EXPECT_EQ(counted.rows[1].conditions.trial, order_[4].conditions.trial);
    EXPECT_EQ(counted.records, 7U);
    EXPECT_EQ(counted.missing, 2U);
    EXPECT_EQ(why(1), LeftOut::kPractice);
    EXPECT_EQ(why(2), LeftOut::kSuperseded);
    EXPECT_EQ(why(3), LeftOut::kRejected);
    EXPECT_EQ(why(5), LeftOut::kExcluded);
    EXPECT_EQ(why(6), LeftOut::kFailed);
    const auto words = describe(counted);
    EXPECT_THAT(words, Contains(HasSubstr("2 of 7 records of 1 participant")));
    EXPECT_THAT(words, Contains(HasSubstr("sub-02 trial 3 (record 5): phone rang")));
    EXPECT_THAT(words, Contains(HasSubstr("peer_lost_visual")));
    EXPECT_THAT(words, Contains(HasSubstr("without a valid record: 2")));
}

TEST_F(CountedTrialsTest, AWholeSessionCountsWhole) {
    for (std::size_t position = 1; position <= 5; ++position) did(position);
    const CountedTrials counted = counted_trials(dataset_);
    EXPECT_EQ(counted.rows.size(), 4U);
    EXPECT_EQ(counted.missing, 0U);
}

TEST_F(CountedTrialsTest, NobodyHasDoneAnything) {
    EXPECT_EQ(counted_trials(dataset_).missing, 4U);
    EXPECT_EQ(counted_trials(Dataset(directory_ / "nothing")).participants, 0U);
}

}  // namespace
}  // namespace thimble
