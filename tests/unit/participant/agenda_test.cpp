// The next step, from the files.
#include "session/participant/agenda.hpp"

#include <functional>
#include <sstream>

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

}  // namespace
}  // namespace thimble
