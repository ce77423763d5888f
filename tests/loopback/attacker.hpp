// An attacker on the wire between a session and a node with a device. It hears every datagram and has no key.
// It may send anything to any port, from the peers' own host, as often as it likes.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <set>
#include <variant>
#include <vector>

#include "common/queue_channel.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/security/lab_key_file.hpp"
#include "common/security/security.hpp"
#include "tests/loopback/lone_node.hpp"

namespace thimble {

inline constexpr Duration kOrderPeriod = std::chrono::milliseconds{50};
inline constexpr Duration kCommandPeriod = std::chrono::milliseconds{1};
inline constexpr Duration kTurn = std::chrono::microseconds{100};  // of a loop that others must not wait for
inline constexpr double kStep = 1e-5;  // metres or newtons; less is no force to a finger
const std::string kNear = "127.0.0.1";

// The force that a node reports; none while it gives out nothing.
inline std::optional<double> given_out(const Body& body) {
    if (const auto* answer = std::get_if<ForceFeedback>(&body))
        return answer->needle_held ? std::nullopt : std::optional{answer->position_needle_m};
    double force_N = 0;
    if (const auto* answer = std::get_if<NeedleCommand>(&body)) force_N = answer->force_hand_N;
    if (const auto* answer = std::get_if<Percept>(&body)) force_N = answer->force_N;
    return force_N == 0 ? std::nullopt : std::optional{force_N};
}

using Overheard = std::vector<std::vector<std::uint8_t>>;

// Passes everything on and remembers it.
class OverheardChannel final : public Channel {
  public:
    OverheardChannel(const std::optional<Endpoint>& local, const Endpoint& remote) : wire_(local, remote) {}
    void send(Bytes datagram) override {
        said.emplace_back(datagram.begin(), datagram.end());
        wire_.send(datagram);
    }

    Overheard said, heard;

  private:
    Bytes take() override {
        const Bytes datagram = wire_.receive();
        if (!datagram.empty()) heard.emplace_back(datagram.begin(), datagram.end());
        return datagram;
    }
    UdpChannel wire_;
};

// A node under attack: who commands it, where, and where it says what it did.
struct AttackTarget {
    const char* name;
    const char* program;
    const char* config;
    Role node, commander;
    Port session, control;             // of its control channel, the session's end and its own
    Port commands, before_relay;       // where it is commanded, and where the commander sends that to
    Port answers_arrive, answers_for;  // where the test hears its answers, and whose they are in a session
    Modality modality;
};
// The name of its test.
inline void PrintTo(const AttackTarget& target, std::ostream* out) { *out << target.name; }
// The needle's position, the handle's force, the finger's force: what each of them says it gave out.
inline constexpr std::array kAttackTargets{
    AttackTarget{"slave_sim", "thimble-slave-sim", "", Role::kSlaveSim, Role::kMaster, Port::kSessionSlave,
                 Port::kSlaveControl, Port::kSlaveNeedle, Port::kNetemNeedle, Port::kSessionRecord,
                 Port::kSessionRecord, Modality::kHF},
    AttackTarget{"master", "thimble-master", "[master]\nstale = 'zero'\n", Role::kMaster, Role::kSlaveSim,
                 Port::kSessionMaster, Port::kMasterControl, Port::kMasterForce, Port::kNetemForceMaster,
                 Port::kNetemNeedle, Port::kSlaveNeedle, Modality::kHF},
    AttackTarget{"cutaneous", "thimble-cutaneous", "", Role::kCutaneous, Role::kSlaveSim,
                 Port::kSessionCutaneous, Port::kCutaneousControl, Port::kCutaneousForce,
                 Port::kNetemForceCutaneous, Port::kMasterPerceptCutaneous, Port::kMasterPerceptCutaneous,
                 Modality::kCF}};

// The session of a lone node, which also commands it, under a lab key, and is overheard. Every command is a position or a force of
// its own, and whatever the node says that it gave out is compared with those.
class OverheardSession {
  public:
    // `rig`: of the session, where it is not the node's.
    OverheardSession(LoneNode& node, const AttackTarget& target, const std::filesystem::path& key_file,
                     const std::string& rig = "")
        : target_(target),
          control_wire_(network_at(node.base_port()).at(target.session), node.at(target.control)),
          command_wire_(std::nullopt, node.at(target.commands)),
          answer_wire_(network_at(node.base_port()).at(target.answers_arrive), {kNear, 0}),
          security_(std::make_shared<const LabKey>(key_of_rig(
                        read_lab_key(key_file), rig.empty() ? network_at(node.base_port()).rig() : rig)),
                    system_random_bytes()),
          control_(security_.pair(control_wire_, target.session, target.control)),
          commanding_end_(security_.outlet(command_wire_, target.commands)),
          before_relay_(security_.outlet(command_wire_, target.before_relay)),
          answering_end_(open_answers()),
          heartbeats_(target.node),
          answers_flow_(target.node),
          orders_(Role::kSession, system_entropy(), {control_}),
          commands_(target.commander, system_entropy(), {commanding_end_}),
          early_(target.commander, system_entropy(), {before_relay_}) {}

    // True once a trial runs; called again, another one.
    bool start(Duration limit = kPatience) {
        ++trial_;
        state_ = NodeState::kIdle;
        return wait_until(
            [this] {
                turn(wall_now());
                return state_ == NodeState::kRunning;
            },
            limit);
    }
    // Commands one position or force after the other, 1 ms apart, while `meanwhile` does what it likes, until that says it is done. False:
    // patience ended.
    bool command(const std::function<bool()>& meanwhile) {
        commanding_ = true;
        const SessionTime end = wall_now() + kPatience;
        bool done = false;
        for (SessionTime now = wall_now(); !done && now < end; now = wall_now()) {
            turn(now);
            done = meanwhile();
            wall_sleep(kTurn);
        }
        commanding_ = false;
        return done;
    }
    // As the commander sends it to the relay, but to the node at once.
    void command_past_the_relay() { send(early_, kStep / 2); }
    // The next command is answered.
    bool still_answers() {
        const double before = commanded_.empty() ? 0 : *commanded_.rbegin();
        return command([&] { return newest_answer_ > before; });
    }

    // to the node, on both flows
    Overheard said() const {
        Overheard all = control_wire_.said;
        all.insert(all.end(), command_wire_.said.begin(), command_wire_.said.end());
        return all;
    }
    const Overheard& commands() const { return command_wire_.said; }
    // from it
    Overheard heard() const {
        Overheard all = control_wire_.heard;
        all.insert(all.end(), answer_wire_.heard.begin(), answer_wire_.heard.end());
        return all;
    }
    std::size_t answers() const { return answers_; }
    std::size_t foreign() const { return foreign_; }  // answers without a command
    NodeState state() const { return state_; }

  private:
    // Of a needle the test plays the relay: it has the keys of both hops.
    Channel* open_answers() {
        if (target_.answers_arrive == target_.answers_for)
            return security_.inlet(answer_wire_, target_.answers_for);
        relay_in_ = security_.inlet(answer_wire_, target_.answers_arrive);
        relay_out_ = security_.outlet(relayed_.a, target_.answers_for);
        return security_.inlet(relayed_.b, target_.answers_for);
    }

    void turn(SessionTime now) {
        security_.tick(now);
        if (now >= next_order_) {
            SessionControl order;
            order.kind = ControlKind::kTrialStart;
            order.modality = target_.modality;
            order.fixture_position_m = 0.035;
            orders_.send(now, trial_, order);
            next_order_ = now + kOrderPeriod;
        }
        while (const Message* message = heartbeats_.receive(now, *control_)) {
            const auto* heartbeat = std::get_if<Heartbeat>(&message->body);
            if (heartbeat != nullptr && message->header.trial == trial_) state_ = heartbeat->state;
        }
        if (commanding_ && now >= next_command_) {
            send_command();
            next_command_ = now + kCommandPeriod;
        }
        take_answers(now);
        security_.tick(now);
    }
    void send_command() {
        const double value = kStep * static_cast<double>(commanded_.size() + 1);
        commanded_.insert(value);
        send(commands_, value);
    }
    void send(OutboundFlow& flow, double value) {
        const SessionTime now = wall_now();
        if (target_.node == Role::kSlaveSim) {
            NeedleCommand command;
            command.position_needle_m = value;
            flow.send(now, trial_, command);
        } else {
            ForceFeedback command;
            command.force_total_N = command.force_fixture_N = -value;
            command.echo_time = now;  // answers the newest message: an old force presses no finger
            flow.send(now, trial_, command);
        }
    }
    void take_answers(SessionTime now) {
        for (Bytes passed; relay_in_ != nullptr && !(passed = relay_in_->receive()).empty();)
            relay_out_->send(passed);
        while (const Message* message = answers_flow_.receive(now, *answering_end_)) {
            const std::optional<double> answer = given_out(message->body);
            if (!answer) continue;
            ++answers_;
            newest_answer_ = *answer;
            if (commanded_.count(*answer) == 0) ++foreign_;
        }
    }

    RealtimeLease realtime_{
        RuntimeSettings{}};  // as of `thimble run`: where it stands still, the node gives up
    AttackTarget target_;
    OverheardChannel control_wire_, command_wire_, answer_wire_;
    QueuePipe relayed_;
    Security security_;
    Channel *relay_in_ = nullptr, *relay_out_ = nullptr;
    Channel *control_, *commanding_end_, *before_relay_, *answering_end_;
    InboundFlow heartbeats_, answers_flow_;
    OutboundFlow orders_, commands_, early_;
    std::uint32_t trial_ = 0;
    SessionTime next_order_{}, next_command_{};
    bool commanding_ = false;
    NodeState state_ = NodeState::kIdle;
    std::set<double> commanded_;
    double newest_answer_ = 0;
    std::size_t answers_ = 0, foreign_ = 0;
};

// Sends to the node's two ports.
class Attacker {
  public:
    Attacker(LoneNode& node, const AttackTarget& target)
        : control_port_(target.control),
          command_port_(target.commands),
          control_(std::nullopt, node.at(target.control)),
          commands_(std::nullopt, node.at(target.commands)) {}

    // to both
    void say(const std::vector<std::uint8_t>& datagram) {
        control_.send(datagram);
        commands_.send(datagram);
        sent_ += 2;
    }
    void replay(const Overheard& datagrams) {
        for (const auto& datagram : datagrams) say(datagram);
    }
    // Each of them with a bit changed, another one every time.
    void replay_changed(const Overheard& datagrams) {
        for (const auto& datagram : datagrams) {
            auto changed = datagram;
            const std::size_t bit = changes_++ * 7 % (8 * changed.size());
            changed[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
            say(changed);
        }
    }
    // Handshakes and sealed datagrams, made up; a portion of them. Nearly all are refused before anything is computed.
    void flood(std::size_t datagrams) {
        std::vector<std::uint8_t> made_up(kHandshakeBytes, 0);
        for (std::size_t i = 0; i < datagrams; i += 2) {
            const auto kind = static_cast<PacketKind>(1 + i / 2 % 6);
            const Port port = i / 2 % 2 == 0 ? control_port_ : command_port_;
            write_seal_header({kind, port, static_cast<std::uint32_t>(i), sent_ + 1},
                              std::span(made_up).first<kSealHeaderBytes>());
            say(made_up);
        }
    }
    // The costly kind: under the name of the key that is in use, which every header says, with counters yet to come. Each costs its
    // receiver a verification.
    void flood_in_the_name_of(const Overheard& commands, std::size_t datagrams) {
        if (commands.empty()) return;
        auto made_up = commands.back();
        auto header = read_seal_header(made_up);
        if (!header) return;
        for (std::size_t i = 0; i < datagrams; ++i) {
            ++header->counter;
            write_seal_header(*header, std::span(made_up).first<kSealHeaderBytes>());
            commands_.send(made_up);
            ++sent_;
        }
    }
    std::size_t sent() const { return sent_; }

  private:
    Port control_port_, command_port_;
    UdpChannel control_, commands_;
    std::size_t sent_ = 0, changes_ = 0;
};

}  // namespace thimble
