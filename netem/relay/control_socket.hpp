// The control socket of a running relay: a Unix datagram socket that only its owner may write to. Its thread reads
// requests (control_text.hpp) and answers them; whatever comes in, the relay goes on.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>

#include "netem/relay/control_handler.hpp"

namespace thimble {

class ControlServer {
  public:
    // Starts the thread, which keeps the default scheduling: make this object before asking for real time. A socket
    // that a dead program left at `path` is replaced. Throws Error (network) if `path` is in use or cannot be made.
    ControlServer(const std::filesystem::path& path, ControlHandler& handler);
    // Removes the socket.
    ~ControlServer();
    ControlServer(const ControlServer&) = delete;
    ControlServer& operator=(const ControlServer&) = delete;

  private:
    void run();
    void answer_one();
    std::string answer(std::string_view request);

    std::filesystem::path path_;
    ControlHandler* handler_;
    int socket_ = -1;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

// Sends one request and waits for its answer. Throws Error: network if no answer comes within five seconds, usage with the relay's own words if it refused.
nlohmann::ordered_json ask_relay(const std::filesystem::path& path, const std::string& request);

}  // namespace thimble
