// Who stands on the wire between a session and a slave_sim: hears every datagram, has no key, and may say anything, from the
// peers' own host, to any port, as often as it likes.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <vector>

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

// The session of a lone slave_sim, which also commands its needle, under a lab key, and is overheard. Every command has a
// position of its own, and every answer is compared with those.
class OverheardSession {
  public:
    OverheardSession(LoneNode& slave, const std::filesystem::path& key_file);

    // True once a trial runs.
    bool start();
    // Commands one position after the other, 1 ms apart, while `meanwhile` does what it likes, until that says it is done. False:
    // patience ended.
    bool command(const std::function<bool()>& meanwhile);
    // The next command is answered.
    bool still_answers();

    Overheard said() const;   // to the slave, on both flows
    Overheard heard() const;  // from it
    std::size_t answers() const { return answers_; }
    std::size_t foreign_positions() const { return foreign_positions_; }  // that nobody commanded
    NodeState state() const { return state_; }

  private:
    void turn(SessionTime now);
    void take_answers(SessionTime now);

    OverheardChannel control_wire_, needle_wire_, record_wire_;
    Security security_;
    Channel *control_, *needle_, *record_;
    InboundFlow heartbeats_{Role::kSlaveSim}, answers_flow_{Role::kSlaveSim};
    OutboundFlow orders_, commands_;
    SessionTime next_order_{}, next_command_{};
    bool commanding_ = false;
    NodeState state_ = NodeState::kIdle;
    std::set<double> commanded_;
    double newest_answer_m_ = 0;
    std::size_t answers_ = 0, foreign_positions_ = 0;
};

// Sends to the slave's two ports.
class Attacker {
  public:
    explicit Attacker(LoneNode& slave);

    void say(const std::vector<std::uint8_t>& datagram);  // to both
    void replay(const Overheard& datagrams);
    // Each of them with a bit changed, another one every time.
    void replay_changed(const Overheard& datagrams);
    // Handshakes and sealed datagrams, made up; a portion of them.
    void flood(std::size_t datagrams);
    std::size_t sent() const { return sent_; }

  private:
    UdpChannel control_, needle_;
    std::size_t sent_ = 0, changes_ = 0;
};

}  // namespace thimble
