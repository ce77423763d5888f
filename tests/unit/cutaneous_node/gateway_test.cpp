// Drives behind a cannelloni gateway whose network repeats datagrams and
// changes their order.
#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/cutaneous_node/drive_bench.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

using Datagram = std::vector<std::uint8_t>;

// A node's end of a network that a gateway sends through.
class UnrulyNetwork final : public Channel {
  public:
    explicit UnrulyNetwork(Channel& inner) : inner_(&inner) {}
    void send(Bytes datagram) override { inner_->send(datagram); }
    void put(const Datagram& datagram) { waiting_.push_back(datagram); }

    bool repeats = false;  // sends each datagram again, ten datagrams later
    bool swaps = false;    // swaps each pair

  private:
    Bytes take() override {
        if (looked_ && !late_.empty()) waiting_.push_back(std::exchange(late_, {}));
        for (Bytes in = inner_->receive(); !in.empty(); in = inner_->receive()) bring({in.begin(), in.end()});
        looked_ = waiting_.empty();
        if (looked_) return {};
        taken_ = waiting_.front();
        waiting_.pop_front();
        return taken_;
    }
    void bring(const Datagram& datagram) {
        if (swaps && held_.empty()) {
            held_ = datagram;
            return;
        }
        waiting_.push_back(datagram);
        late_ = std::exchange(held_, {});
        if (!repeats) return;
        waiting_.push_back(datagram);
        before_.push_back(datagram);
        if (before_.size() < 10) return;
        waiting_.push_back(before_.front());
        before_.pop_front();
    }

    Channel* inner_;
    std::deque<Datagram> waiting_, before_;
    Datagram held_, late_, taken_;
    bool looked_ = false;
};

// A datagram with one frame whose identifier is as told.
Datagram numbered(std::uint8_t sequence, std::uint8_t id) { return {2, 0, sequence, 0, 1, 0, 0, 0, id, 0}; }

class Gateway : public testing::Test {
  protected:
    // Frames of what the network has brought, by their identifiers.
    std::vector<std::uint32_t> heard(SessionTime now) {
        std::vector<std::uint32_t> ids;
        for (CanFrame frame; bus.receive(now, frame);) {
            ids.push_back(frame.id);
            orders.push_back(frame.order);
        }
        return ids;
    }
    using Ids = std::vector<std::uint32_t>;

    QueuePipe pipe;
    UnrulyNetwork network{pipe.a};
    CannelloniBus bus{network};
    std::vector<std::uint64_t> orders;
};

TEST_F(Gateway, ARepeatedDatagramIsTakenOnceAcrossEveryWrap) {
    CannelloniBus far(pipe.b);
    network.repeats = true;
    for (std::uint32_t id = 0; id < 1000; ++id) {
        far.send({.id = id});
        far.flush();
        EXPECT_EQ(heard(at(milliseconds{id})), Ids{id});
    }
    EXPECT_TRUE(std::is_sorted(orders.begin(), orders.end()));
    EXPECT_EQ(bus.counters().repeated, 1000U + 991U);
    EXPECT_EQ(bus.counters().late, 0U);
}

TEST_F(Gateway, ALateDatagramComesWithItsPlaceInTheOrder) {
    for (const std::uint8_t sequence : Datagram{253, 255, 254, 1, 0, 0, 254, 4, 130, 3, 2})
        network.put(numbered(sequence, sequence));
    EXPECT_EQ(heard(at({})), (Ids{253, 255, 254, 1, 0, 4, 130, 3, 2}));
    const std::uint64_t first = orders.front();
    for (std::uint64_t& order : orders) order -= first;
    EXPECT_EQ(orders, (std::vector<std::uint64_t>{0, 2, 1, 4, 3, 7, 133, 6, 5}));
    EXPECT_EQ(bus.counters().repeated, 2U);
    EXPECT_EQ(bus.counters().late, 4U);
}

TEST_F(Gateway, OneThatIsStartedAnewIsHeardAndItsDataAreNewer) {
    for (int i = 0; i < 100; ++i) network.put(numbered(static_cast<std::uint8_t>(i), 1));
    EXPECT_EQ(heard(at({})).size(), 100U);
    network.put(numbered(0, 1));
    EXPECT_TRUE(heard(at(milliseconds{100})).empty());
    network.put(numbered(0, 1));
    network.put(numbered(1, 1));
    EXPECT_EQ(heard(at(milliseconds{101})).size(), 2U);
    EXPECT_TRUE(std::is_sorted(orders.begin(), orders.end()));
    EXPECT_EQ(bus.counters().repeated, 1U);
}

struct UnrulyQueue : DriveQueue {
    UnrulyNetwork network{here_};
    CannelloniBus bus{network};
    CanBus& near_end() { return bus; }
};

TEST(DrivesBehindAGateway, RepeatedDatagramsAreNoSecondDevice) {
    DriveBench<UnrulyQueue> bench;
    bench.network.repeats = true;
    ASSERT_TRUE(bench.come_up()) << bench.fault();
    bench.press(Finger::kIndex, 1, std::chrono::seconds{2});
    EXPECT_EQ(bench.fault(), "");
    EXPECT_NEAR(bench.felt_N(), 1, 0.02);
    EXPECT_GT(bench.bus.counters().repeated, 1000U);
}

TEST(DrivesBehindAGateway, AnOldMeasurementIsNotTakenAsNew) {
    DriveBench<UnrulyQueue> bench;
    ASSERT_TRUE(bench.come_up()) << bench.fault();
    bench.network.swaps = true;
    // The force grows from one SYNC to the next, so an older measurement shows as
    // a smaller one.
    double before_N = 0;
    for (int cycle = 0; cycle < 100; ++cycle) {
        bench.actuator.command(bench.now, Finger::kIndex, 0.01 * cycle);
        for (int ms = 0; ms < 4; ++ms) {
            bench.tick();
            const double measured_N = bench.actuator.measured_N(0);
            ASSERT_GE(measured_N, before_N - 1e-9) << cycle;
            before_N = measured_N;
        }
    }
    EXPECT_GT(before_N, 0.8);
    EXPECT_GT(bench.bus.counters().late, 20U);
    EXPECT_EQ(bench.fault(), "");
}

}  // namespace
}  // namespace thimble
