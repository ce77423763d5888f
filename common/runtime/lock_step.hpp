// The protocol of lock-step (docs/lock-step.md): a conductor grants the time to the programs of a session, one after another. Here is
// one end of it, and the loop of a program that takes part.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <boost/core/noncopyable.hpp>

#include "common/network_settings.hpp"
#include "common/process.hpp"
#include "common/runtime/sockets.hpp"

namespace thimble {

inline constexpr std::uint16_t kLockStepVersion = 1;

enum class LockStepKind : std::uint16_t {
    kBegin = 1,  // conductor: a trial begins, be as good as new. time: how long a datagram may take
    kGrant,      // conductor: it is `time`; so many datagrams have been sent to each of your ports
    kEnd,        // conductor: the last trial has ended
    kReady,      // node: my ports are open. time: my next wake-up
    kAnswer,  // node: I have done what is due. time: my next wake-up; so many datagrams I have sent to each port
};

// As on the wire, little-endian: one message is one datagram of a Unix socket (SOCK_SEQPACKET).
struct LockStepMessage {
    std::uint16_t version = kLockStepVersion;
    LockStepKind kind{};
    std::uint32_t reserved = 0;
    std::int64_t time_ns = 0;
    std::uint64_t instance = 0;  // of kBegin: the node's own number in the headers of its messages
    std::array<std::uint16_t, 36> datagrams{};  // by Port, as far as there are ports
};
static_assert(sizeof(LockStepMessage) == 96 && kPortCount <= 36);

// One end of the socket between conductor and node.
class LockStepEnd : boost::noncopyable {
  public:
    // Takes the descriptor. Waits for a message no longer than `limit`; zero: for ever.
    LockStepEnd(int descriptor, Duration limit);
    ~LockStepEnd();

    // False: the other end is gone.
    bool send(const LockStepMessage& message) const;
    enum class Silence { kLate, kGone, kInterrupted };
    // Throws Error (network) if it is no message of this version.
    std::optional<LockStepMessage> receive();
    Silence silence() const { return silence_; }  // why receive() gave nothing

  private:
    int descriptor_;
    Silence silence_ = Silence::kGone;
};

// Answers each grant with a tick, until another order comes, which it returns; none if the conductor is gone or a signal ends the program.
// Throws Error (network) if a datagram does not come.
std::optional<LockStepMessage> run_in_lock_step(LockStepEnd& conductor, Process& process, Sockets& sockets);

}  // namespace thimble
