// Who stands on the wire between a session and a node that moves something or presses: hears every datagram, has no key, and may say anything, from the
// peers' own host, to any port, as often as it likes.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <set>
#include <vector>

#include "common/queue_channel.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/security/security.hpp"
#include "tests/loopback/lone_node.hpp"

namespace thimble {

using Overheard = std::vector<std::vector<std::uint8_t>>;

// Passes everything on and remembers it.
class OverheardChannel final : public Channel {
  public:
    OverheardChannel(const std::optional<Endpoint>& local, const Endpoint& remote) : wire_(local, remote) {}
    void send(Bytes datagram) override;

    Overheard said, heard;

  private:
    Bytes take() override;
    UdpChannel wire_;
};

// A node under attack: who commands it, where, and where it says what it did.
struct AttackTarget {
    const char* name;
    const char* program;
    const char* config;
    Role node, commander;
    Port session, control;             // of its control channel, the session's end and its own
    Port commands;                     // where it is commanded
    Port answers_arrive, answers_for;  // where the test hears its answers, and whose they are in a session
    Modality modality;
};
// The name of its test.
inline void PrintTo(const AttackTarget& target, std::ostream* out) { *out << target.name; }
// The needle's position, the handle's force, the finger's force: what each of them says it gave out.
inline constexpr std::array kAttackTargets{
    AttackTarget{"slave_sim", "thimble-slave-sim", "", Role::kSlaveSim, Role::kMaster, Port::kSessionSlave,
                 Port::kSlaveControl, Port::kSlaveNeedle, Port::kSessionRecord, Port::kSessionRecord,
                 Modality::kHF},
    AttackTarget{"master", "thimble-master", "[master]\nstale = 'zero'\n", Role::kMaster, Role::kSlaveSim,
                 Port::kSessionMaster, Port::kMasterControl, Port::kMasterForce, Port::kNetemNeedle,
                 Port::kSlaveNeedle, Modality::kHF},
    AttackTarget{"cutaneous", "thimble-cutaneous", "", Role::kCutaneous, Role::kSlaveSim,
                 Port::kSessionCutaneous, Port::kCutaneousControl, Port::kCutaneousForce,
                 Port::kMasterPerceptCutaneous, Port::kMasterPerceptCutaneous, Modality::kCF}};

// Whoever in a session hears the answers of a node under attack, and so has their key: a peer that the test plays, beside its
// session.
class AnswerListener {
  public:
    // `session` and `wire` outlive it.
    AnswerListener(Security& session, const std::shared_ptr<const LabKey>& lab, Channel& wire,
                   Port answers_for);
    void turn(SessionTime now);
    Channel& answers() { return *answers_; }

  private:
    QueuePipe control_;  // a: session, b: the peer
    Security security_;
    Channel *at_session_, *at_peer_, *answers_;
};

// The session of a lone node, which also commands it, under a lab key, and is overheard. Every command is a position or a force of
// its own, and whatever the node says that it gave out is compared with those.
class OverheardSession {
  public:
    OverheardSession(LoneNode& node, const AttackTarget& target, const std::filesystem::path& key_file);

    // True once a trial runs; called again, another one.
    bool start();
    // Commands one position or force after the other, 1 ms apart, while `meanwhile` does what it likes, until that says it is done. False:
    // patience ended.
    bool command(const std::function<bool()>& meanwhile);
    // The next command is answered.
    bool still_answers();

    Overheard said() const;  // to the node, on both flows
    const Overheard& commands() const { return command_wire_.said; }
    Overheard heard() const;  // from it
    std::size_t answers() const { return answers_; }
    std::size_t foreign() const { return foreign_; }  // answers without a command
    NodeState state() const { return state_; }

  private:
    void turn(SessionTime now);
    void send_command(SessionTime now);
    void take_answers(SessionTime now);

    AttackTarget target_;
    std::shared_ptr<const LabKey> lab_;
    OverheardChannel control_wire_, command_wire_, answer_wire_;
    Security security_;
    Channel *control_, *commanding_end_;
    std::optional<AnswerListener> listener_;
    Channel* answering_end_ = nullptr;
    InboundFlow heartbeats_, answers_flow_;
    OutboundFlow orders_, commands_;
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
    Attacker(LoneNode& node, const AttackTarget& target);

    void say(const std::vector<std::uint8_t>& datagram);  // to both
    void replay(const Overheard& datagrams);
    // Each of them with a bit changed, another one every time.
    void replay_changed(const Overheard& datagrams);
    // Handshakes and sealed datagrams, made up; a portion of them. Nearly all are refused before anything is computed.
    void flood(std::size_t datagrams);
    // The costly kind: under the name of the key that is in use, which every header says, with counters yet to come. Each costs its
    // receiver a verification.
    void flood_in_the_name_of(const Overheard& commands, std::size_t datagrams);
    std::size_t sent() const { return sent_; }

  private:
    Port control_port_, command_port_;
    UdpChannel control_, commands_;
    std::size_t sent_ = 0, changes_ = 0;
};

}  // namespace thimble
