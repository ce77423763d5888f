// One real node process; the test stands for all its peers, so that it sees what only the node's peers see.
#pragma once

#include <csignal>
#include <functional>
#include <stdexcept>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/flow.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "tests/loopback/programs.hpp"

namespace thimble {

inline constexpr std::uint64_t kSessionInstance = 1;
inline constexpr Duration kRepeat = std::chrono::milliseconds{50};

inline std::vector<std::string> node_arguments(const Folder& folder, const PortBlock& ports,
                                               const std::string& config,
                                               const std::vector<std::string>& more) {
    const bool secured = config.find("[security]") != std::string::npos;
    return words_in(
        fmt::format("--base-port {} {} --report {} --die-with-parent={}", ports.base(),
                    folder.write("node.toml", config + (secured ? "" : kUnprotectedTable)).string(),
                    (folder / "report.json").string(), getpid()),
        more);
}

inline Channel* control_channel(Sockets& sockets, Role role) {
    switch (role) {
        case Role::kMaster:
            return sockets.between(Port::kSessionMaster, Port::kMasterControl);
        case Role::kSlaveSim:
            return sockets.between(Port::kSessionSlave, Port::kSlaveControl);
        case Role::kCutaneous:
            return sockets.between(Port::kSessionCutaneous, Port::kCutaneousControl);
        case Role::kVisual:
            return sockets.between(Port::kSessionVisual, Port::kVisualControl);
        case Role::kNetem:
            return sockets.between(Port::kSessionNetem, Port::kNetemControl);
        case Role::kExperimenter:
            break;  // no node
        case Role::kSession:
            break;
    }
    throw std::invalid_argument("not a node");
}

class LoneNode {
  public:
    // `program` with the tables of `config` (TOML), on ports of its own.
    explicit LoneNode(const std::string& program, const std::string& config = "",
                      const std::vector<std::string>& more_arguments = {})
        : network_(network_at(ports_.base())),
          peers_(network_),
          child_(built_programs() / program, node_arguments(folder_, ports_, config, more_arguments),
                 folder_ / "words") {}

    // waits until it reports that
    bool ready() {
        return wait_until([this] { return words().find("ready") != std::string::npos; });
    }
    Child& process() { return child_; }
    // SIGTERM; its exit code, -1 if it does not end.
    int terminate() {
        child_.signal(SIGTERM);
        return child_.wait(kPatience).value_or(-1);
    }
    std::string words() const { return read_text(folder_ / "words"); }
    std::filesystem::path report_file() const { return folder_ / "report.json"; }
    nlohmann::json report() const { return nlohmann::json::parse(read_text(report_file())); }
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
    HeardHeartbeats(LoneNode& node, Role role)
        : channel_(control_channel(node.peers(), role)), answers_(role) {}

    // Waits for one that the node sent at or after `since`: it says "ready" before its loop turns.
    bool wait_for_one_sent(SessionTime since) {
        return wait_until([&] {
            while (const Message* message = answers_.receive(wall_now(), *channel_)) {
                if (message->header.send_time >= since) return true;
            }
            return false;
        });
    }

  private:
    Channel* channel_;
    InboundFlow answers_;
};

// The session as that node sees it: repeats its order, which is also its sign of life, and hears the answers.
class PlayedSession {
  public:
    PlayedSession(LoneNode& node, Role role, Modality modality)
        : channel_(control_channel(node.peers(), role)),
          answers_(role),
          orders_(Role::kSession, kSessionInstance, {channel_}) {
        order_.kind = ControlKind::kTrialStart;
        order_.modality = modality;
        order_.fixture_position_m = 0.035;
    }

    // Every few milliseconds: plays the session, then `peer`, until `done`. False if patience ended first.
    bool play(const std::function<void(SessionTime now)>& peer, const std::function<bool()>& done) {
        return wait_until([&] {
            const SessionTime now = wall_now();
            tick(now);
            peer(now);
            return done();
        });
    }
    NodeState state() const { return state_; }
    EndReason reason() const { return reason_; }

  private:
    void tick(SessionTime now) {
        if (now >= next_order_) {
            orders_.send(now, kPlayedTrial, order_);
            next_order_ = now + kRepeat;
        }
        while (const Message* message = answers_.receive(now, *channel_)) {
            const auto* heartbeat = std::get_if<Heartbeat>(&message->body);
            if (heartbeat == nullptr || message->header.trial != kPlayedTrial) continue;
            state_ = heartbeat->state;
            reason_ = heartbeat->reason;
        }
    }

    RealtimeLease realtime_{
        RuntimeSettings{}};  // as of `thimble run`: where it stands still, the node gives up
    Channel* channel_;
    InboundFlow answers_;
    OutboundFlow orders_;
    SessionControl order_;
    SessionTime next_order_{};
    NodeState state_ = NodeState::kIdle;
    EndReason reason_ = EndReason::kNone;
};

}  // namespace thimble
