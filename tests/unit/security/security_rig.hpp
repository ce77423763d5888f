// Two ends of a wire that remembers all that was said on it, and randomness that a test can repeat.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string_view>
#include <vector>

#include "common/security/security.hpp"

namespace thimble {

using Datagram = std::vector<std::uint8_t>;

// One end. It records each datagram and passes it to its peer, unless it is cut.
class TestWire final : public Channel {
  public:
    void connect(TestWire& peer) { peer_ = &peer; }
    void send(Bytes datagram) override;
    void answer(Bytes datagram) override { send(datagram); }
    void deliver(const Datagram& datagram) { waiting_.push_back(datagram); }

    bool cut = false;
    std::vector<Datagram> said;

  private:
    Bytes take() override;
    TestWire* peer_ = nullptr;
    std::deque<Datagram> waiting_;
    Datagram taken_;
};

struct TestPipe {
    TestWire a, b;
    TestPipe() {
        a.connect(b);
        b.connect(a);
    }
};

RandomBytes seeded_bytes(std::uint64_t seed);
std::shared_ptr<const LabKey> test_lab_key(std::uint8_t byte = 7);
Bytes bytes_of(std::string_view text);
// The next datagram that gets through, as text; "" if none does.
std::string received(Channel& channel);
std::string hex(std::span<const std::uint8_t> bytes);

// A node that listens at kMasterControl and its session, without anything behind them.
class PairRig {
  public:
    explicit PairRig(const SecurityTimes& times = {});

    // Each in turn, until no end has anything to send at this instant.
    void turn(Duration later = {});
    // A new process in the place of the old one; what the old one was sent is lost.
    void restart_node(const std::shared_ptr<const LabKey>& lab = test_lab_key());
    void restart_session(const std::shared_ptr<const LabKey>& lab = test_lab_key());

    SecurityTimes times;
    SessionTime now{std::chrono::hours{5}};
    TestPipe wire;  // a: the session's end, b: the node's
    std::shared_ptr<const LabKey> session_lab, node_lab;
    std::unique_ptr<SecurePair> session, node;

  private:
    std::uint64_t lives_ = 0;
};

}  // namespace thimble
