// The control socket of a running relay: a Unix datagram socket that only its owner may write to. Its thread reads
// requests (control_text.hpp) and answers them; whatever comes in, the relay goes on.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <string>
#include <thread>

#include <boost/core/noncopyable.hpp>
#include <nlohmann/json.hpp>

#include "netem/relay/relay_totals.hpp"

namespace thimble {

class RelayEngine;

class ControlServer : boost::noncopyable {
  public:
    // Starts the thread, which keeps the default scheduling: make this object before asking for real time. A socket
    // that a dead program left at `path` is replaced. Throws Error (network) if `path` is in use or cannot be made.
    explicit ControlServer(const std::filesystem::path& path);
    // Removes the socket.
    ~ControlServer();

    // For the relaying thread, in each of its rounds: what the other thread asks for. Never waits.
    void serve(RelayEngine& engine);

  private:
    using Job = std::function<RelayState(RelayEngine& engine)>;
    using Task = std::packaged_task<RelayState(RelayEngine& engine)>;

    void run();
    void answer_one();
    std::string answer(std::string_view request);
    RelayState ask(const Job& job);

    std::filesystem::path path_;
    int socket_ = -1;
    std::atomic<Task*> waiting_{nullptr};
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

// Sends one request and waits for its answer. Throws Error: network if no answer comes within five seconds, usage with
// the relay's own words if it refused.
nlohmann::ordered_json ask_relay(const std::filesystem::path& path, const std::string& request);

}  // namespace thimble
