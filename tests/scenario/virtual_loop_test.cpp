// The virtual clock, tried on processes that only write down when they are called.
#include "session/virtual/virtual_loop.hpp"

#include <functional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr SessionTime at_ms(int ms) { return SessionTime{milliseconds{ms}}; }

struct Call {
    char who;
    SessionTime when;
    bool operator==(const Call&) const = default;
};
using Calls = std::vector<Call>;

void PrintTo(const Call& call, std::ostream* stream) {
    *stream << call.who << '@' << to_nanoseconds(call.when);
}

class Scripted final : public Process {
  public:
    Scripted(char name, SessionTime next, Calls& calls) : next_(next), name_(name), calls_(&calls) {}
    void tick(SessionTime now) override {
        calls_->push_back({name_, now});
        if (now >= next_) next_ = kNever;
        if (act) act(now);
    }
    SessionTime next_wakeup() const override { return next_; }
    bool stopped() const override { return false; }

    void wake_at(SessionTime time) { next_ = time; }
    std::function<void(SessionTime)> act;

  private:
    SessionTime next_;
    char name_;
    Calls* calls_;
};

class VirtualLoopTest : public testing::Test {
  protected:
    void run() {
        while (loop.step()) {
        }
    }
    Calls calls;
    VirtualLoop loop;
};

TEST_F(VirtualLoopTest, NothingDueIsNoStep) {
    EXPECT_FALSE(loop.step());
    Scripted idle('a', kNever, calls);
    loop.add(idle);
    EXPECT_FALSE(loop.step());
    EXPECT_EQ(loop.now(), SessionTime{});
    EXPECT_EQ(loop.ticks(), 0U);
    EXPECT_TRUE(calls.empty());
}

TEST_F(VirtualLoopTest, JumpsFromEventToEvent) {
    Scripted a('a', at_ms(5), calls), b('b', at_ms(2), calls);
    loop.add(a);
    loop.add(b);
    a.act = [&](SessionTime now) {
        if (now == at_ms(5)) a.wake_at(at_ms(1'000'000));
    };
    run();
    EXPECT_EQ(calls, (Calls{{'b', at_ms(2)}, {'a', at_ms(5)}, {'a', at_ms(1'000'000)}}));
    EXPECT_EQ(loop.ticks(), 3U);
}

TEST_F(VirtualLoopTest, AtOneInstantInTheOrderTheyWereAdded) {
    Scripted a('a', at_ms(3), calls), b('b', at_ms(3), calls), c('c', at_ms(3), calls);
    for (Scripted* process : {&c, &a, &b}) loop.add(*process);
    EXPECT_TRUE(loop.step());
    EXPECT_EQ(calls, (Calls{{'c', at_ms(3)}, {'a', at_ms(3)}, {'b', at_ms(3)}}));
}

// Forwards within the sweep, backwards in the next one; all in the same instant.
TEST_F(VirtualLoopTest, WhatIsWokenRunsInTheSameInstant) {
    Scripted a('a', kNever, calls), b('b', at_ms(1), calls), c('c', kNever, calls);
    const std::uint32_t bit_a = loop.add(a);
    loop.add(b);
    const std::uint32_t bit_c = loop.add(c);
    b.act = [&](SessionTime) { *loop.wake_mask() |= bit_a | bit_c; };
    EXPECT_TRUE(loop.step());
    EXPECT_EQ(calls, (Calls{{'b', at_ms(1)}, {'c', at_ms(1)}, {'a', at_ms(1)}}));
    EXPECT_FALSE(loop.step());
}

TEST_F(VirtualLoopTest, AWokenProcessIsTickedOnceHoweverManyMessagesWait) {
    Scripted a('a', at_ms(1), calls), b('b', kNever, calls);
    loop.add(a);
    const std::uint32_t bit_b = loop.add(b);
    a.act = [&](SessionTime) {
        for (int i = 0; i < 5; ++i) *loop.wake_mask() |= bit_b;
    };
    run();
    EXPECT_EQ(calls.size(), 2U);
}

TEST_F(VirtualLoopTest, APokeMakesAProcessDueNow) {
    Scripted a('a', at_ms(7), calls);
    const std::uint32_t bit = loop.add(a);
    loop.poke(bit);
    EXPECT_TRUE(loop.step());
    EXPECT_EQ(calls, (Calls{{'a', SessionTime{}}}));
    EXPECT_TRUE(loop.step());
    EXPECT_EQ(calls.back(), (Call{'a', at_ms(7)}));
}

TEST_F(VirtualLoopTest, TimeNeverGoesBack) {
    Scripted a('a', at_ms(5), calls);
    loop.add(a);
    int left = 3;
    a.act = [&](SessionTime) {
        if (left-- > 0) a.wake_at(at_ms(1));  // in the past: now
    };
    run();
    EXPECT_EQ(calls, Calls(4, Call{'a', at_ms(5)}));
}

TEST_F(VirtualLoopTest, EndlessMessagesAreAProgramError) {
    Scripted a('a', at_ms(1), calls), b('b', kNever, calls);
    const std::uint32_t bit_a = loop.add(a), bit_b = loop.add(b);
    a.act = [&](SessionTime) { *loop.wake_mask() |= bit_b; };
    b.act = [&](SessionTime) { *loop.wake_mask() |= bit_a; };
    EXPECT_THROW(loop.step(), std::logic_error);
}

TEST_F(VirtualLoopTest, AChangedWakeUpCountsAfterTheTick) {
    Scripted a('a', at_ms(10), calls), b('b', at_ms(1), calls);
    const std::uint32_t bit_a = loop.add(a);
    loop.add(b);
    b.act = [&](SessionTime) {
        a.wake_at(at_ms(4));  // behind the loop's back, so it must be told
        loop.poke(bit_a);
    };
    run();
    EXPECT_EQ(calls, (Calls{{'b', at_ms(1)}, {'a', at_ms(1)}, {'a', at_ms(4)}}));
}

}  // namespace
}  // namespace thimble
