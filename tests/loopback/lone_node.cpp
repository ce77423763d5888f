#include "tests/loopback/lone_node.hpp"

#include <csignal>
#include <stdexcept>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr std::uint64_t kSessionInstance = 1;
constexpr Duration kRepeat = std::chrono::milliseconds{50};

std::vector<std::string> node_arguments(const Folder& folder, const PortBlock& ports,
                                        const std::string& config, const std::vector<std::string>& more) {
    return words_in(fmt::format("--base-port {} {} --report {} --die-with-parent={}", ports.base(),
                                folder.write("node.toml", "# a test's\n" + config).string(),
                                (folder / "report.json").string(), getpid()),
                    more);
}

Channel* control_channel(Sockets& sockets, Role role) {
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

}  // namespace

LoneNode::LoneNode(const std::string& program, const std::string& config,
                   const std::vector<std::string>& more_arguments)
    : network_(network_at(ports_.base())),
      peers_(network_),
      child_(built_programs() / program, node_arguments(folder_, ports_, config, more_arguments),
             folder_ / "words") {}

bool LoneNode::ready() {
    return wait_until([this] { return words().find("ready") != std::string::npos; });
}

int LoneNode::terminate() {
    child_.signal(SIGTERM);
    return child_.wait(kPatience).value_or(-1);
}

HeardHeartbeats::HeardHeartbeats(LoneNode& node, Role role)
    : channel_(control_channel(node.peers(), role)), answers_(role) {}

bool HeardHeartbeats::wait_for_one_sent(SessionTime since) {
    return wait_until([&] {
        while (const Message* message = answers_.receive(wall_now(), *channel_)) {
            if (message->header.send_time >= since) return true;
        }
        return false;
    });
}

PlayedSession::PlayedSession(LoneNode& node, Role role, Modality modality)
    : channel_(control_channel(node.peers(), role)),
      answers_(role),
      orders_(Role::kSession, kSessionInstance, {channel_}) {
    order_.kind = ControlKind::kTrialStart;
    order_.modality = modality;
    order_.fixture_position_m = 0.035;
}

bool PlayedSession::play(const std::function<void(SessionTime now)>& peer,
                         const std::function<bool()>& done) {
    return wait_until([&] {
        const SessionTime now = wall_now();
        tick(now);
        peer(now);
        return done();
    });
}

void PlayedSession::tick(SessionTime now) {
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

}  // namespace thimble
