// Metrics of a running relay for Prometheus: GET /metrics over HTTP, from a thread of its own. Each connection has one request
// of a limited size, a limited time, and one answer; whatever comes in, the relay goes on.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/runtime/udp_socket.hpp"
#include "common/time.hpp"
#include "netem/relay/relay_mailbox.hpp"

namespace thimble {

class MetricsServer : boost::noncopyable {
  public:
    // Starts the thread, which keeps the default scheduling: make this object before asking for real time. Throws Error
    // (network) if the port is taken.
    explicit MetricsServer(const UdpAddress& local);
    ~MetricsServer();

    // For the relaying thread, in each of its rounds. Never waits.
    void serve(SteeredRelay& relay) { mailbox_.serve(relay); }
    UdpAddress address() const;

  private:
    struct Visitor {
        int socket;
        SessionTime until;  // then it is turned away, whatever it has said or read
        std::string said{}, answer{};
    };

    void run();
    void let_in();
    bool attend(Visitor& visitor);  // false: it is done
    std::string answer_to(const std::string& request);

    int socket_ = -1;
    std::vector<Visitor> visitors_;
    RelayMailbox mailbox_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace thimble
