// Metrics of a running relay for Prometheus: GET /metrics over HTTP, from a thread of its own. Each connection has one request
// of a limited size, a limited time, and one answer; whatever comes in, the relay goes on.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <boost/core/noncopyable.hpp>

#include "common/runtime/udp_socket.hpp"
#include "netem/relay/relay_mailbox.hpp"
#include "netem/relay/request_server.hpp"

namespace thimble {

class MetricsServer : boost::noncopyable {
  public:
    // Starts the thread, which keeps the default scheduling: make this object before asking for real time. Throws Error
    // (network) if the port is taken.
    explicit MetricsServer(const UdpAddress& local);

    // For the relaying thread, in each of its rounds. Never waits.
    void serve(SteeredRelay& relay) { mailbox_.serve(relay); }
    UdpAddress address() const;

  private:
    std::optional<std::string> answer_to(std::string_view request);

    RelayMailbox mailbox_;
    RequestServer server_;  // the last: its thread asks the mailbox
};

}  // namespace thimble
