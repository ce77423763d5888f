#include "tests/loopback/attacker.hpp"

#include <optional>
#include <thread>
#include <variant>

#include "common/runtime/wall_clock.hpp"
#include "common/security/lab_key_file.hpp"

namespace thimble {
namespace {

constexpr Duration kOrderPeriod = std::chrono::milliseconds{50};
constexpr Duration kCommandPeriod = std::chrono::milliseconds{1};
constexpr double kStep = 1e-5;  // metres or newtons; less is no force to a finger
const std::string kNear = "127.0.0.1";

// The force that a node reports; none while it gives out nothing.
std::optional<double> given_out(const Body& body) {
    if (const auto* answer = std::get_if<ForceFeedback>(&body))
        return answer->needle_held ? std::nullopt : std::optional{answer->position_needle_m};
    double force_N = 0;
    if (const auto* answer = std::get_if<NeedleCommand>(&body)) force_N = answer->force_hand_N;
    if (const auto* answer = std::get_if<Percept>(&body)) force_N = answer->force_N;
    return force_N == 0 ? std::nullopt : std::optional{force_N};
}

}  // namespace

void OverheardChannel::send(Bytes datagram) {
    said.emplace_back(datagram.begin(), datagram.end());
    wire_.send(datagram);
}

Bytes OverheardChannel::take() {
    const Bytes datagram = wire_.receive();
    if (!datagram.empty()) heard.emplace_back(datagram.begin(), datagram.end());
    return datagram;
}

AnswerListener::AnswerListener(Security& session, const std::shared_ptr<const LabKey>& lab, Channel& wire,
                               Port answers_for)
    : security_(lab, system_random_bytes()) {
    const bool of_master = owner(answers_for) == Role::kMaster;
    const Port at_session = of_master ? Port::kSessionMaster : Port::kSessionSlave;
    const Port at_peer = of_master ? Port::kMasterControl : Port::kSlaveControl;
    at_session_ = session.pair(control_.a, at_session, at_peer);
    at_peer_ = security_.pair(control_.b, at_peer, at_session);
    answers_ = security_.inlet(wire, answers_for);
}

// Nothing but keys comes on its control channel.
void AnswerListener::turn(SessionTime now) {
    security_.tick(now);
    at_session_->receive();
    at_peer_->receive();
    security_.tick(now);
}

OverheardSession::OverheardSession(LoneNode& node, const AttackTarget& target,
                                   const std::filesystem::path& key_file)
    : target_(target),
      lab_(std::make_shared<const LabKey>(read_lab_key(key_file))),
      control_wire_(network_at(node.base_port()).at(target.session), node.at(target.control)),
      command_wire_(std::nullopt, node.at(target.commands)),
      answer_wire_(network_at(node.base_port()).at(target.answers_arrive), {kNear, 0}),
      security_(lab_, system_random_bytes()),
      control_(security_.pair(control_wire_, target.session, target.control)),
      commanding_end_(security_.outlet(command_wire_, target.commands)),
      heartbeats_(target.node),
      answers_flow_(target.node),
      orders_(Role::kSession, system_entropy(), {control_}),
      commands_(target.commander, system_entropy(), {commanding_end_}) {
    if (owner(target.answers_for) == Role::kSession) {
        answering_end_ = security_.inlet(answer_wire_, target.answers_for);
    } else {
        listener_.emplace(security_, lab_, answer_wire_, target.answers_for);
        answering_end_ = &listener_->answers();
    }
}

bool OverheardSession::start() {
    ++trial_;
    state_ = NodeState::kIdle;
    return wait_until([this] {
        turn(wall_now());
        return state_ == NodeState::kRunning;
    });
}

bool OverheardSession::command(const std::function<bool()>& meanwhile) {
    commanding_ = true;
    const SessionTime end = wall_now() + kPatience;
    bool done = false;
    for (SessionTime now = wall_now(); !done && now < end; now = wall_now()) {
        turn(now);
        done = meanwhile();
        std::this_thread::yield();
    }
    commanding_ = false;
    return done;
}

bool OverheardSession::still_answers() {
    const double before = commanded_.empty() ? 0 : *commanded_.rbegin();
    return command([&] { return newest_answer_ > before; });
}

void OverheardSession::turn(SessionTime now) {
    security_.tick(now);
    if (listener_) listener_->turn(now);
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
        send_command(now);
        next_command_ = now + kCommandPeriod;
    }
    take_answers(now);
    security_.tick(now);
}

void OverheardSession::send_command(SessionTime now) {
    const double value = kStep * static_cast<double>(commanded_.size() + 1);
    commanded_.insert(value);
    if (target_.node == Role::kSlaveSim) {
        NeedleCommand command;
        command.position_needle_m = value;
        commands_.send(now, trial_, command);
    } else {
        ForceFeedback command;
        command.force_total_N = command.force_fixture_N = -value;
        command.echo_time = now;  // answers the newest message: an old force presses no finger
        commands_.send(now, trial_, command);
    }
}

void OverheardSession::take_answers(SessionTime now) {
    while (const Message* message = answers_flow_.receive(now, *answering_end_)) {
        const std::optional<double> answer = given_out(message->body);
        if (!answer) continue;
        ++answers_;
        newest_answer_ = *answer;
        if (commanded_.count(*answer) == 0) ++foreign_;
    }
}

Overheard OverheardSession::said() const {
    Overheard all = control_wire_.said;
    all.insert(all.end(), command_wire_.said.begin(), command_wire_.said.end());
    return all;
}

Overheard OverheardSession::heard() const {
    Overheard all = control_wire_.heard;
    all.insert(all.end(), answer_wire_.heard.begin(), answer_wire_.heard.end());
    return all;
}

Attacker::Attacker(LoneNode& node, const AttackTarget& target)
    : control_port_(target.control),
      command_port_(target.commands),
      control_(std::nullopt, node.at(target.control)),
      commands_(std::nullopt, node.at(target.commands)) {}

void Attacker::say(const std::vector<std::uint8_t>& datagram) {
    control_.send(datagram);
    commands_.send(datagram);
    sent_ += 2;
}

void Attacker::replay(const Overheard& datagrams) {
    for (const auto& datagram : datagrams) say(datagram);
}

void Attacker::replay_changed(const Overheard& datagrams) {
    for (const auto& datagram : datagrams) {
        auto changed = datagram;
        const std::size_t bit = changes_++ * 7 % (8 * changed.size());
        changed[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        say(changed);
    }
}

void Attacker::flood(std::size_t datagrams) {
    std::vector<std::uint8_t> made_up(kHandshakeBytes, 0);
    for (std::size_t i = 0; i < datagrams; i += 2) {
        const auto kind = static_cast<PacketKind>(1 + i / 2 % 5);
        const Port port = i / 2 % 2 == 0 ? control_port_ : command_port_;
        write_seal_header({kind, port, static_cast<std::uint32_t>(i), sent_ + 1},
                          std::span(made_up).first<kSealHeaderBytes>());
        say(made_up);
    }
}

void Attacker::flood_in_the_name_of(const Overheard& commands, std::size_t datagrams) {
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

}  // namespace thimble
