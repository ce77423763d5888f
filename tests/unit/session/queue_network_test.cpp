// The ports of a session as queues: who gets which datagram, who wakes, and what a tap sees.
#include "session/virtual/queue_network.hpp"

#include <string>

#include <gtest/gtest.h>

namespace thimble {
namespace {

Bytes bytes_of(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string text_of(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

TEST(QueueNetwork, ADatagramWaitsAtItsPortAndWakesTheProgramThere) {
    QueueNetwork network;
    std::uint32_t woken = 0;
    network.wake(Role::kSlaveSim, &woken, 4);
    Channel* const sender = network.of(Role::kNetem).outlet(Port::kSlaveNeedle);
    sender->send(bytes_of("before the inlet is open"));
    EXPECT_EQ(woken, 4U);
    Channel* const needle = network.of(Role::kSlaveSim).inlet(Port::kSlaveNeedle);
    sender->send(bytes_of("second"));
    EXPECT_EQ(text_of(needle->receive()), "before the inlet is open");
    EXPECT_EQ(text_of(needle->receive()), "second");
    EXPECT_TRUE(needle->receive().empty());
}

TEST(QueueNetwork, AControlChannelGoesBothWaysAndWakesTheOtherEndOnly) {
    QueueNetwork network;
    std::uint32_t woken = 0;
    network.wake(Role::kSession, &woken, 1);
    network.wake(Role::kMaster, &woken, 2);
    Channel* const session = network.of(Role::kSession).between(Port::kSessionMaster, Port::kMasterControl);
    Channel* const master = network.of(Role::kMaster).between(Port::kMasterControl, Port::kSessionMaster);
    session->send(bytes_of("order"));
    EXPECT_EQ(woken, 2U);
    EXPECT_EQ(text_of(master->receive()), "order");
    master->send(bytes_of("heartbeat"));
    EXPECT_EQ(woken, 3U);
    EXPECT_EQ(text_of(session->receive()), "heartbeat");
}

TEST(QueueNetwork, AStopReachesAllProgramsFromEach) {
    QueueNetwork network;
    for (const Role role : {Role::kSession, Role::kMaster, Role::kNetem}) {
        const StopOutlets outlets = stop_outlets(network.of(role));
        for (std::size_t i = 0; i < outlets.size(); ++i) {
            outlets[i]->send(bytes_of(to_string(role)));
            Channel* const heard = network.of(owner(kStopPorts[i])).inlet(kStopPorts[i]);
            EXPECT_EQ(text_of(heard->receive()), to_string(role));
        }
    }
}

class Shouting final : public Channel {
  public:
    explicit Shouting(Channel& end) : end_(&end) {}
    void send(Bytes datagram) override { end_->send(bytes_of(text_of(datagram) + "!")); }

  private:
    Bytes take() override { return end_->receive(); }
    Channel* end_;
};

TEST(QueueNetwork, ATapStandsBeforeTheEndThatSends) {
    QueueNetwork network(nullptr, [](Port to, Channel& end) -> std::unique_ptr<Channel> {
        return to == Port::kVisualScene ? std::make_unique<Shouting>(end) : nullptr;
    });
    network.of(Role::kSlaveSim).outlet(Port::kVisualScene)->send(bytes_of("beep"));
    EXPECT_EQ(text_of(network.of(Role::kVisual).inlet(Port::kVisualScene)->receive()), "beep!");
    network.of(Role::kSlaveSim).outlet(Port::kSessionRecord)->send(bytes_of("record"));
    EXPECT_EQ(text_of(network.of(Role::kSession).inlet(Port::kSessionRecord)->receive()), "record");
}

}  // namespace
}  // namespace thimble
