#include <arpa/inet.h>
#include <memory>
#include <sys/socket.h>

#include <spdlog/spdlog.h>

#include "common/runtime/event_waiter.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/datagram_batch.hpp"
#include "thimble/link_test/echo_responder.hpp"
#include "thimble/link_test/port_probe.hpp"

namespace thimble {
namespace {

constexpr Duration kStopLatency = std::chrono::milliseconds{100};
// A flood at one port must not delay the others or Ctrl-C.
constexpr int kBatchesPerTurn = 4;

class EchoServer {
  public:
    explicit EchoServer(const EchoPlan& plan) : responder_(EchoLimits{}, system_entropy), waiter_(false) {
        for (const Port port : plan.ports) {
            const auto number = static_cast<std::uint16_t>(plan.base_port + static_cast<unsigned>(port));
            sockets_.push_back(UdpSocket::listening({htonl(INADDR_ANY), htons(number)}));
            forbid_fragments(sockets_.back());
            waiter_.add(sockets_.back().descriptor(), sockets_.size() - 1);
            ports_.push_back(port);
        }
    }

    EchoCounters run(const EchoPlan& plan) {
        const SessionTime end = wall_now() + plan.limit;
        std::array<epoll_event, 32> room{};
        for (SessionTime now = wall_now(); now < end && !*plan.stop; now = wall_now()) {
            for (const epoll_event& event : waiter_.wait(kNever, std::min(end, now + kStopLatency), room))
                serve(event.data.u64);
            say_news();
        }
        return responder_.counters();
    }

  private:
    void serve(std::size_t i) {
        for (int batches = 0; batches < kBatchesPerTurn; ++batches) {
            const std::size_t count = batch_.receive(sockets_[i].descriptor());
            for (std::size_t n = 0; n < count; ++n) answer(i, batch_[n]);
            if (count < ReceiveBatch::kSize) return;
        }
    }

    void answer(std::size_t i, const ReceiveBatch::Datagram& datagram) {
        const SessionTime arrived = clock_.arrival(datagram.stamp_realtime_ns);
        // The batch's own memory, which is not read again.
        const std::span room(const_cast<std::uint8_t*>(datagram.bytes.data()), datagram.bytes.size());
        if (!responder_.answer(wall_now(), arrived, datagram.from.host, static_cast<std::uint16_t>(ports_[i]),
                               room))
            return;
        const sockaddr_in to = datagram.from.generic();
        sendto(sockets_[i].descriptor(), room.data(), room.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
               static_cast<const sockaddr*>(static_cast<const void*>(&to)), sizeof to);
    }

    void say_news() {
        if (responder_.counters().begun == begun_) return;
        begun_ = responder_.counters().begun;
        spdlog::info("a test from another machine has begun ({} since the start)", begun_);
    }

    EchoResponder responder_;
    EventWaiter waiter_;
    std::vector<UdpSocket> sockets_;
    std::vector<Port> ports_;
    ReceiveBatch batch_;
    ArrivalClock clock_;
    std::uint64_t begun_ = 0;
};

}  // namespace

EchoCounters serve_echoes(const EchoPlan& plan) {
    EchoServer server(plan);
    spdlog::info("ready to answer tests, {} ports from {}, for {:g} s", plan.ports.size(), plan.base_port,
                 to_seconds(plan.limit));
    return server.run(plan);
}

}  // namespace thimble
