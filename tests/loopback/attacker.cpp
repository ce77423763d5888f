#include "tests/loopback/attacker.hpp"

#include <thread>

#include "common/runtime/wall_clock.hpp"
#include "common/security/lab_key_file.hpp"

namespace thimble {
namespace {

constexpr Duration kOrderPeriod = std::chrono::milliseconds{50};
constexpr Duration kCommandPeriod = std::chrono::milliseconds{1};
constexpr double kStep_m = 1e-6;
const std::string kNear = "127.0.0.1";

NetworkSettings ports_of(const LoneNode& slave) {
    NetworkSettings network;
    network.base_port = slave.at(Port::kSessionMaster).port;
    return network;
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

OverheardSession::OverheardSession(LoneNode& slave, const std::filesystem::path& key_file)
    : control_wire_(ports_of(slave).at(Port::kSessionSlave), slave.at(Port::kSlaveControl)),
      needle_wire_(std::nullopt, slave.at(Port::kSlaveNeedle)),
      record_wire_(ports_of(slave).at(Port::kSessionRecord), {kNear, 0}),
      security_(std::make_shared<const LabKey>(read_lab_key(key_file)), system_random_bytes()),
      control_(security_.pair(control_wire_, Port::kSessionSlave, Port::kSlaveControl)),
      needle_(security_.outlet(needle_wire_, Port::kSlaveNeedle)),
      record_(security_.inlet(record_wire_, Port::kSessionRecord)),
      orders_(Role::kSession, system_entropy(), {control_}),
      commands_(Role::kMaster, system_entropy(), {needle_}) {}

bool OverheardSession::start() {
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
    const double before_m = commanded_.empty() ? 0 : *commanded_.rbegin();
    return command([&] { return newest_answer_m_ > before_m; });
}

void OverheardSession::turn(SessionTime now) {
    security_.tick(now);
    if (now >= next_order_) {
        SessionControl order;
        order.kind = ControlKind::kTrialStart;
        order.fixture_position_m = 0.035;
        orders_.send(now, kPlayedTrial, order);
        next_order_ = now + kOrderPeriod;
    }
    while (const Message* message = heartbeats_.receive(now, *control_)) {
        const auto* heartbeat = std::get_if<Heartbeat>(&message->body);
        if (heartbeat != nullptr && message->header.trial == kPlayedTrial) state_ = heartbeat->state;
    }
    if (commanding_ && now >= next_command_) {
        NeedleCommand command;
        command.position_needle_m = kStep_m * static_cast<double>(commanded_.size() + 1);
        commanded_.insert(command.position_needle_m);
        commands_.send(now, kPlayedTrial, command);
        next_command_ = now + kCommandPeriod;
    }
    take_answers(now);
    security_.tick(now);
}

void OverheardSession::take_answers(SessionTime now) {
    while (const Message* message = answers_flow_.receive(now, *record_)) {
        const auto* answer = std::get_if<ForceFeedback>(&message->body);
        if (answer == nullptr || answer->needle_held) continue;
        ++answers_;
        newest_answer_m_ = answer->position_needle_m;
        if (commanded_.count(answer->position_needle_m) == 0) ++foreign_positions_;
    }
}

Overheard OverheardSession::said() const {
    Overheard all = control_wire_.said;
    all.insert(all.end(), needle_wire_.said.begin(), needle_wire_.said.end());
    return all;
}

Overheard OverheardSession::heard() const {
    Overheard all = control_wire_.heard;
    all.insert(all.end(), record_wire_.heard.begin(), record_wire_.heard.end());
    return all;
}

Attacker::Attacker(LoneNode& slave)
    : control_(std::nullopt, slave.at(Port::kSlaveControl)),
      needle_(std::nullopt, slave.at(Port::kSlaveNeedle)) {}

void Attacker::say(const std::vector<std::uint8_t>& datagram) {
    control_.send(datagram);
    needle_.send(datagram);
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
        const Port port = i / 2 % 2 == 0 ? Port::kSlaveControl : Port::kSlaveNeedle;
        write_seal_header({kind, port, static_cast<std::uint32_t>(i), sent_ + 1},
                          std::span(made_up).first<kSealHeaderBytes>());
        say(made_up);
    }
}

}  // namespace thimble
