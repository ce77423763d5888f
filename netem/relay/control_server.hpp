// The control socket of a running relay: a Unix socket with a path that only its owner may write to, also from another
// network namespace or a container that sees the path. Each connection brings one request (control_text.hpp) and gets one
// answer; whatever comes in, the relay goes on.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <boost/core/noncopyable.hpp>
#include <nlohmann/json.hpp>

#include "netem/relay/relay_mailbox.hpp"
#include "netem/relay/request_server.hpp"

namespace thimble {

class ControlServer : boost::noncopyable {
  public:
    // Starts the thread, which keeps the default scheduling: make this object before asking for real time. A socket
    // that a dead program left at `path` is replaced. Throws Error (network) if `path` is in use or cannot be made.
    explicit ControlServer(const std::filesystem::path& path);
    // Removes the socket.
    ~ControlServer();

    // For the relaying thread, in each of its rounds: what the other thread asks for. Never waits.
    void serve(SteeredRelay& relay) { mailbox_.serve(relay); }

  private:
    std::string answer(std::string_view request);

    std::filesystem::path path_;
    RelayMailbox mailbox_;
    RequestServer server_;  // the last: its thread asks the mailbox
};

// Sends one request and waits for its answer. Throws Error: network if no answer comes within five seconds, usage with
// the relay's own words if it refused.
nlohmann::ordered_json ask_relay(const std::filesystem::path& path, const std::string& request);

}  // namespace thimble
