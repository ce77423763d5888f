// Order and wide bounds only: how well time is kept is measured elsewhere and never passes or fails a test.
#include "common/runtime/realtime_loop.hpp"

#include <array>
#include <csignal>
#include <cstdlib>
#include <sched.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/unit/common/packet.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Wants to be called every period; remembers when it was.
class Ticker final : public Process {
  public:
    Ticker(SessionTime first, Duration period, std::size_t count)
        : next_(first), period_(period), count_(count) {}
    void tick(SessionTime now) override {
        ticks.push_back(now);
        if (now >= next_) {
            due.push_back(next_);
            late.push_back(now - next_);
            next_ += period_;
        }
    }
    SessionTime next_wakeup() const override { return next_; }
    bool stopped() const override { return due.size() >= count_; }

    std::vector<SessionTime> ticks, due;
    std::vector<Duration> late;

  private:
    SessionTime next_;
    Duration period_;
    std::size_t count_;
};

TEST(RealtimeLease, IsOneStepBelowTheNodesAndNotHandedDown) {
    std::thread([] {
        {
            const RealtimeLease lease(RuntimeSettings{.priority = 42});
            if (!lease.granted()) GTEST_SKIP() << "this user may not have SCHED_FIFO: root, or ulimit -r";
            sched_param got{};
            sched_getparam(0, &got);
            EXPECT_EQ(got.sched_priority, 41);
            EXPECT_EQ(sched_getscheduler(0), SCHED_FIFO | SCHED_RESET_ON_FORK);
            int policy = -1;
            std::thread([&policy] { policy = sched_getscheduler(0); }).join();
            EXPECT_EQ(policy, SCHED_OTHER);
        }
        EXPECT_EQ(sched_getscheduler(0) & ~SCHED_RESET_ON_FORK, SCHED_OTHER);
    }).join();
}

TEST(RealtimeLease, NothingIsAskedForWhereTheFileSaysNo) {
    const int before = sched_getscheduler(0);
    const RealtimeLease lease(RuntimeSettings{.realtime_scheduling = false});
    EXPECT_FALSE(lease.granted());
    EXPECT_EQ(sched_getscheduler(0), before);
}

TEST(WallClock, GoesForward) {
    SessionTime last = wall_now();
    for (int i = 0; i < 1000; ++i) {
        const SessionTime now = wall_now();
        ASSERT_GE(now, last);
        last = now;
    }
    EXPECT_NE(system_entropy(), system_entropy());
}

TEST(RealtimeLoop, NeverEarlyAndOncePerDeadline) {
    Ticker ticker(wall_now() + milliseconds{2}, milliseconds{2}, 20);
    RealtimeLoop loop({});
    loop.run(ticker);
    ASSERT_EQ(ticker.due.size(), 20U);
    for (const Duration late : ticker.late) {
        EXPECT_GE(late, Duration{0});
        EXPECT_LT(late, seconds{20});  // a machine this slow tells nothing
    }
    EXPECT_EQ(loop.statistics().deadlines, 20U);
    EXPECT_EQ(loop.statistics().lateness.count(), 20U);
}

// Datagrams to `receiver`, which listens on a port of the kernel's choice.
void send_one(const UdpChannel& receiver) {
    UdpChannel(std::nullopt, Endpoint{"127.0.0.1", port_of(receiver)}).send(Packet{1});
}

TEST(RealtimeLoop, ADatagramWakesItBeforeItsDeadline) {
    UdpChannel receiver(Endpoint{"127.0.0.1", 0}, Endpoint{"127.0.0.1", 0});
    const std::array<Listener*, 1> listeners{&receiver};
    RealtimeLoop loop(listeners);
    Ticker ticker(wall_now() + seconds{600}, seconds{1}, 1);
    send_one(receiver);
    loop.step(ticker, kNever);
    EXPECT_EQ(ticker.ticks.size(), 1U);
    EXPECT_TRUE(ticker.due.empty());
    EXPECT_EQ(loop.statistics().arrivals, 1U);
    EXPECT_EQ(loop.statistics().deadlines, 0U);
    loop.step(ticker, kNever);  // the ticker has taken nothing
    EXPECT_EQ(ticker.ticks.size(), 2U);
    EXPECT_EQ(receiver.receive().size(), 1U);
}

TEST(RealtimeLoop, AChannelIsAskedOnlyWhenItHasMail) {
    UdpChannel first(Endpoint{"127.0.0.1", 0}, Endpoint{"127.0.0.1", 0});
    UdpChannel second(Endpoint{"127.0.0.1", 0}, Endpoint{"127.0.0.1", 0});
    Ticker ticker(wall_now() + seconds{600}, seconds{1}, 1);
    {
        const std::array<Listener*, 2> listeners{&first, &second};
        RealtimeLoop loop(listeners);
        EXPECT_TRUE(first.receive().empty());
        EXPECT_TRUE(second.receive().empty());
        send_one(first);
        EXPECT_TRUE(first.known_empty());  // as far as the loop has looked
        EXPECT_TRUE(first.receive().empty());
        send_one(first);
        loop.step(ticker, kNever);
        EXPECT_TRUE(second.known_empty());
        EXPECT_EQ(first.receive().size(), 1U);
        EXPECT_EQ(first.receive().size(), 1U);  // all that came, not one per step
        EXPECT_FALSE(first.known_empty());
        EXPECT_TRUE(first.receive().empty());
        EXPECT_TRUE(first.known_empty());
        send_one(second);
        loop.step(ticker, kNever);
        EXPECT_EQ(second.receive().size(), 1U);
    }
    send_one(first);  // no loop watches any more: it looks for itself
    EXPECT_EQ(first.receive().size(), 1U);
}

// A deadline that moves on with every datagram leaves the timer set to what it was first.
TEST(RealtimeLoop, ADeadlineThatMovedOnIsNotTakenEarly) {
    UdpChannel receiver(Endpoint{"127.0.0.1", 0}, Endpoint{"127.0.0.1", 0});
    const std::array<Listener*, 1> listeners{&receiver};
    RealtimeLoop loop(listeners);
    const SessionTime start = wall_now();
    Ticker soon(start + milliseconds{20}, seconds{600}, 1);
    send_one(receiver);
    loop.step(soon, kNever);  // by mail, or late: the timer is set to 20 ms
    while (!receiver.receive().empty()) {
    }
    Ticker later(start + milliseconds{60}, seconds{600}, 1);
    loop.step(later, kNever);
    ASSERT_EQ(later.ticks.size(), 1U);
    EXPECT_GE(later.ticks[0], start + milliseconds{60});
    Ticker sooner(wall_now() + milliseconds{1}, seconds{600}, 1);
    loop.step(sooner, wall_now() + seconds{10});  // and one that comes nearer is not missed
    ASSERT_EQ(sooner.due.size(), 1U);
    EXPECT_LT(sooner.late[0], seconds{5});
}

TEST(RealtimeLoop, WaitsNoLongerThanItsCallerAllows) {
    Ticker ticker(kNever, seconds{1}, 1);
    RealtimeLoop loop({});
    const SessionTime latest = wall_now() + milliseconds{5};
    loop.step(ticker, latest);
    ASSERT_EQ(ticker.ticks.size(), 1U);
    EXPECT_GE(ticker.ticks[0], latest);
    EXPECT_EQ(loop.statistics().deadlines, 0U);
}

TEST(RealtimeLoop, ADeadlineInThePastIsTakenAtOnce) {
    Ticker ticker(wall_now() - milliseconds{50}, seconds{600}, 1);
    RealtimeLoop loop({});
    loop.run(ticker);
    EXPECT_EQ(loop.statistics().deadlines, 1U);
    EXPECT_EQ(loop.statistics().missed, 1U);
    EXPECT_GE(loop.statistics().lateness.worst(), milliseconds{50});
}

TEST(RealtimeLoop, AStoppedProcessIsNotTicked) {
    Ticker ticker(wall_now(), seconds{1}, 0);
    RealtimeLoop loop({});
    loop.run(ticker);
    EXPECT_TRUE(ticker.ticks.empty());
}

enum class Dead { kUnburied, kBuried };

// Whether a program lives on that asks to stop with its parent when that has died already.
bool lives_on(Dead parent_is) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) return true;
    const pid_t parent = fork();
    if (parent == 0) {
        const pid_t launcher = getpid();
        if (fork() != 0) _exit(0);
        const auto is_there = [&] {
            return parent_is == Dead::kBuried ? kill(launcher, 0) == 0 : getppid() == launcher;
        };
        while (is_there()) usleep(100);
        stop_with_parent(launcher);
        _exit(write(ends[1], "x", 1) == 1 ? 0 : 1);
    }
    close(ends[1]);
    if (parent_is == Dead::kBuried) waitpid(parent, nullptr, 0);
    char byte = 0;
    const bool lives = read(ends[0], &byte, 1) == 1;
    if (parent_is == Dead::kUnburied) waitpid(parent, nullptr, 0);
    close(ends[0]);
    return lives;
}

TEST(StopWithParent, AParentThatHasDiedBeforeEndsTheProgramToo) {
    EXPECT_FALSE(lives_on(Dead::kUnburied));
    EXPECT_FALSE(lives_on(Dead::kBuried));
}

// Such as xvfb-run: the launcher lives, and is not the parent.
TEST(StopWithParentDeathTest, AWrapperBetweenIsNoDeadParent) {
    EXPECT_EXIT(
        {
            stop_with_parent(1);
            std::exit(0);
        },
        testing::ExitedWithCode(0), "");
}

// In a process of its own: the request stays for good.
TEST(RealtimeLoopDeathTest, ATermSignalEndsTheLoop) {
    EXPECT_EXIT(
        {
            install_stop_signals();
            Ticker ticker(wall_now() + seconds{600}, seconds{1}, 1);
            RealtimeLoop loop({});
            std::raise(SIGTERM);
            loop.run(ticker);
            std::exit(stop_requested() ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

// Of programs that hear no emergency stop, Ctrl-\ is no key without an effect.
TEST(RealtimeLoopDeathTest, AQuitSignalEndsTheLoopOrIsAnEmergencyStop) {
    EXPECT_EXIT(
        {
            install_stop_signals();
            std::raise(SIGQUIT);
            std::exit(stop_requested() && emergency_stops() == 0 ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
    EXPECT_EXIT(
        {
            install_stop_signals(QuitSignal::kStopsEverything);
            std::raise(SIGQUIT);
            std::exit(!stop_requested() && emergency_stops() == 1 ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace thimble
