// One real node process; the test plays everybody else, so that it sees what only the node's peers see.
#pragma once

#include <functional>

#include <nlohmann/json.hpp>

#include "common/flow.hpp"
#include "common/runtime/sockets.hpp"
#include "tests/loopback/programs.hpp"

namespace thimble {

class LoneNode {
  public:
    // `program` with the tables of `config` (TOML), on ports of its own.
    explicit LoneNode(const std::string& program, const std::string& config = "",
                      const std::vector<std::string>& more_arguments = {});

    bool ready();  // waits until it says so
    Child& process() { return child_; }
    // SIGTERM; its exit code, -1 if it does not end.
    int terminate();
    std::string words() const { return read_text(folder_ / "words"); }
    nlohmann::json report() const { return nlohmann::json::parse(read_text(folder_ / "report.json")); }
    // The peers' ends of its ports.
    Sockets& peers() { return peers_; }
    std::uint16_t base_port() const { return network_.base_port; }
    Endpoint at(Port port) const { return network_.at(port); }

  private:
    Folder folder_;
    PortBlock ports_;
    NetworkSettings network_;
    Sockets peers_;
    Child child_;
};

inline constexpr std::uint32_t kPlayedTrial = 1;

// The messages that the session hears of a node without sending to it.
class HeardHeartbeats {
  public:
    HeardHeartbeats(LoneNode& node, Role role);

    // Waits for one that the node sent at or after `since`: it says "ready" before its loop turns.
    bool wait_for_one_sent(SessionTime since);

  private:
    Channel* channel_;
    InboundFlow answers_;
};

// The session as that node sees it: repeats its order, which is also its sign of life, and hears the answers.
class PlayedSession {
  public:
    PlayedSession(LoneNode& node, Role role, Modality modality);

    // Every few milliseconds: plays the session, then `peer`, until `done`. False if patience ended first.
    bool play(const std::function<void(SessionTime now)>& peer, const std::function<bool()>& done);
    NodeState state() const { return state_; }
    EndReason reason() const { return reason_; }

  private:
    void tick(SessionTime now);

    Channel* channel_;
    InboundFlow answers_;
    OutboundFlow orders_;
    SessionControl order_;
    SessionTime next_order_{};
    NodeState state_ = NodeState::kIdle;
    EndReason reason_ = EndReason::kNone;
};

}  // namespace thimble
