// How often the stop bus speaks, and how soon it lets go.
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "common/stop_bus.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// Where the line hears: what is put in comes out, answers are counted.
class AskedEnd final : public Channel {
  public:
    void put(Bytes datagram) { waiting_.emplace_back(datagram.begin(), datagram.end()); }
    void send(Bytes /*datagram*/) override {}
    void answer(Bytes /*datagram*/) override { ++answers; }

    int answers = 0;

  private:
    Bytes take() override {
        if (waiting_.empty()) return {};
        taken_ = std::move(waiting_.front());
        waiting_.pop_front();
        return taken_;
    }
    std::deque<std::vector<std::uint8_t>> waiting_;
    std::vector<std::uint8_t> taken_;
};

// The session's line; all others are one pipe.
class LoneLine {
  public:
    LoneLine() {
        StopOutlets out{};
        out.fill(&others_.a);
        line.connect(in, out);
    }
    void hear(const StopOrder& order) {
        Encoder encoder;
        in.put(encoder.encode(Header{9, now, ++sequence_, 0, Role::kExperimenter}, order));
    }
    void tick(Duration time) {
        now = SessionTime{time};
        line.tick(now);
        for (; !others_.b.receive().empty(); ++said) {
        }
    }

    StopBus line{Role::kSession, 1};
    SessionTime now{};
    AskedEnd in;
    int said = 0;

  private:
    QueuePipe others_;
    std::uint32_t sequence_ = 0;
};

const StopOrder kPressed(5, StopKind::kStop, EndReason::kEmergencyStop, "a key");

TEST(StopPace, WhatIsHeldIsPassedOnTwiceASecondUntilItIsReleased) {
    LoneLine rig;
    rig.hear(kPressed);
    for (int ms = 0; ms <= 2000; ++ms) rig.tick(milliseconds{ms});
    EXPECT_EQ(rig.said, 4 * 6);  // to each of six, at 500, 1000, 1500 and 2000 ms
    rig.hear(StopOrder(5, StopKind::kRelease, EndReason::kEmergencyStop, {}));
    for (int ms = 2001; ms <= 3000; ++ms) rig.tick(milliseconds{ms});
    EXPECT_EQ(rig.said, 4 * 6);
    EXPECT_EQ(rig.line.next(), kNever);
}

TEST(StopPace, NothingIsReleasedThatHasJustBeenPressed) {
    LoneLine rig;
    rig.hear(kPressed);
    rig.tick({});
    rig.line.release(SessionTime{milliseconds{199}});
    EXPECT_TRUE(rig.line.stopped());
    rig.line.release(SessionTime{milliseconds{200}});
    EXPECT_FALSE(rig.line.stopped());
}

TEST(StopPace, QuestionsAreAnsweredEveryTenMilliseconds) {
    LoneLine rig;
    rig.hear(kPressed);
    rig.tick({});
    rig.in.answers = 0;
    for (int ms = 10; ms < 60; ++ms) {
        rig.hear(StopOrder(0, StopKind::kAsk, EndReason::kEmergencyStop, {}));
        rig.tick(milliseconds{ms});
    }
    EXPECT_EQ(rig.in.answers, 5);
}

}  // namespace
}  // namespace thimble
