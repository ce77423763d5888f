// Drives behind a cannelloni gateway whose network repeats datagrams and
// changes their order.
#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/drive_actuator.hpp"
#include "cutaneous_node/emulator/emulated_drives.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

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
        CanFrame frame;
        frame.id = id;
        far.send(frame);
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

class DrivesBehindAGateway : public testing::Test {
  protected:
    static DriveSettings read_settings() {
        const ConfigFile file = ConfigFile::parse("[drives]\nbus = \"can0\"\n", "drives.toml");
        return read_drive_settings(file.table("drives"));
    }
    void tick() {
        now += milliseconds{1};
        actuator.tick(now);
        drives.tick(now);
        actuator.tick(now);
    }
    void come_up_and_press() {
        while (!actuator.ready() && actuator.fault().empty() && now < at(seconds{10})) tick();
        ASSERT_TRUE(actuator.ready()) << actuator.fault();
        for (const SessionTime end = now + seconds{2}; now < end; tick())
            actuator.command(now, Finger::kIndex, 1);
        EXPECT_EQ(actuator.fault(), "");
        EXPECT_NEAR(actuator.output(now).force_N, 1, 0.02);
    }

    QueuePipe pipe;
    UnrulyNetwork network{pipe.a};
    CannelloniBus near{network}, far{pipe.b};
    DriveSettings settings = read_settings();
    EmulatedDrives drives{settings.master.nodes, PlantParameters{}, far};
    DriveActuator actuator{settings, 1.5, near};
    SessionTime now{};
};

TEST_F(DrivesBehindAGateway, RepeatedDatagramsAreNoSecondDevice) {
    network.repeats = true;
    come_up_and_press();
    EXPECT_GT(near.counters().repeated, 1000U);
}

TEST_F(DrivesBehindAGateway, AnOldMeasurementIsNotTakenAsNew) {
    while (!actuator.ready() && actuator.fault().empty() && now < at(seconds{10})) tick();
    ASSERT_TRUE(actuator.ready()) << actuator.fault();
    network.swaps = true;
    // The force grows from one SYNC to the next, so an older measurement shows as
    // a smaller one.
    double before_N = 0;
    for (int cycle = 0; cycle < 100; ++cycle) {
        actuator.command(now, Finger::kIndex, 0.01 * cycle);
        for (int ms = 0; ms < 4; ++ms) {
            tick();
            const double measured_N = actuator.measured_N(0);
            ASSERT_GE(measured_N, before_N - 1e-9) << cycle;
            before_N = measured_N;
        }
    }
    EXPECT_GT(before_N, 0.8);
    EXPECT_GT(near.counters().late, 20U);
    EXPECT_EQ(actuator.fault(), "");
}

}  // namespace
}  // namespace thimble
