// The control socket of a running relay: a Unix socket with a path that only its owner may write to, also from another
// network namespace or a container that sees the path. Each connection brings one request (control_text.hpp) and gets one
// answer; whatever comes in, the relay goes on.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <boost/core/noncopyable.hpp>
#include <nlohmann/json.hpp>

#include "common/time.hpp"
#include "netem/relay/relay_mailbox.hpp"

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
    struct Asker {
        int socket = -1;
        SessionTime until{};  // it has to have asked
    };

    void run();
    void let_in();
    void look_at_askers();
    bool answer_one(int asker);  // false: it has not asked yet
    std::string answer(std::string_view request);

    std::filesystem::path path_;
    int socket_ = -1;
    std::vector<Asker> askers_;
    RelayMailbox mailbox_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

// Sends one request and waits for its answer. Throws Error: network if no answer comes within five seconds, usage with
// the relay's own words if it refused.
nlohmann::ordered_json ask_relay(const std::filesystem::path& path, const std::string& request);

}  // namespace thimble
