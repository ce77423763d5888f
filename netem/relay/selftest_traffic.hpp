// Traffic of the self-test's own: a client that sends like a session's master, and a server that answers each datagram
// like slave_sim. It knows when it sent what, and the kernel when it came out at the other end.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/runtime/stamp_clock.hpp"
#include "common/runtime/udp_socket.hpp"
#include "netem/relay/datagram_batch.hpp"
#include "netem/relay/packet_record.hpp"

namespace thimble {

// Datagrams of one direction, by their number.
struct TrafficWay {
    std::vector<SessionTime> sent, arrived;  // arrived: SessionTime{} if it never did
    std::uint64_t strangers = 0;             // arrived, but are none of these: bits were flipped

    // Each datagram's delay, in the order of sending, in seconds.
    std::vector<double> delays_s() const;
};

inline constexpr std::size_t kUpBytes = 104, kDownBytes = 144;  // NeedleCommand, ForceFeedback
inline constexpr Duration kTrafficPeriod = std::chrono::milliseconds{1};

class SelftestTraffic : boost::noncopyable {
  public:
    // `server`: a socket that stamps what comes. `drain`: how long to wait for the last answers.
    SelftestTraffic(std::size_t packets, Duration drain, int server);
    ~SelftestTraffic();

    // In a thread with the scheduling that the caller has now; waits for start().
    void launch();
    void start(int client);  // a socket that is connected to the server
    bool finished() const { return finished_; }
    // Once finished.
    TrafficWay& way(RelayDirection direction) { return ways_[static_cast<std::size_t>(direction)]; }

  private:
    void run();
    void send(RelayDirection direction, int socket, const UdpAddress* to);
    void receive(RelayDirection direction);

    std::size_t packets_;
    Duration drain_;
    int server_, client_ = -1;
    std::array<TrafficWay, 2> ways_;
    ReceiveBatch arrivals_;
    SendBatch out_;
    StampClock stamps_;
    std::atomic<bool> started_{false}, finished_{false}, abandoned_{false};
    std::thread thread_;
};

}  // namespace thimble
