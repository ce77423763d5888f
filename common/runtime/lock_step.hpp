// The protocol of lock-step (docs/clocks.md): a conductor grants the time to the programs of a session, one after another. Here is
// one end of it, and the loop of a program that takes part.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <sys/types.h>

#include <boost/core/noncopyable.hpp>

#include "common/network_settings.hpp"
#include "common/process.hpp"
#include "common/runtime/sockets.hpp"

namespace thimble {

inline constexpr std::uint16_t kLockStepVersion = 2;
// A wait looks so often whether a signal ends the program, and whether the other end still lives.
inline constexpr Duration kLockStepLook = std::chrono::milliseconds{100};

enum class LockStepKind : std::uint16_t {
    kBegin = 1,  // conductor: a trial begins, be as good as new. time: how long a datagram may take
    kGrant,      // conductor: it is `time`; so many datagrams have been sent to each of your ports
    kEnd,        // conductor: the last trial has ended
    kReady,      // node: my ports are open. time: my next wake-up
    kAnswer,  // node: I have done what is due. time: my next wake-up; so many datagrams I have sent to each port
    kQuietGrant,  // conductor: as kGrant, but without an answer, since the node will not send and is due no earlier
};

// As on the wire, little-endian: one message is one datagram of a Unix socket (SOCK_SEQPACKET).
struct LockStepMessage {
    std::uint16_t version = kLockStepVersion;
    LockStepKind kind{};
    std::uint32_t by_page =
        0;  // of the first kReady, 1: from now on both ends use the page that came with kBegin
    std::int64_t time_ns = 0;
    // Of kBegin: the node's own number in the headers of its messages. Of kAnswer: before that time, in ns, forces may come by kQuietGrant.
    std::uint64_t instance = 0;
    std::array<std::uint16_t, 36> datagrams{};  // by Port, as far as there are ports
};
static_assert(sizeof(LockStepMessage) == 96 && kPortCount <= 36);

// Memory of both ends, which costs half of what the socket does. A futex is how many messages were written; there is room for that
// many which the other end has not read.
struct LockStepPage {
    static constexpr std::uint32_t kRoom = 32;
    struct Slot {
        alignas(64) std::atomic<std::uint32_t> turn = 0;
        std::array<LockStepMessage, kRoom> messages;
    };
    Slot order, answer;
};
static_assert(sizeof(LockStepPage) == 6272);

class GrantStream;

// One end of the socket between conductor and node.
class LockStepEnd : boost::noncopyable {
  public:
    // Takes the descriptor. Waits for a message no longer than `limit`; zero: for ever.
    LockStepEnd(int descriptor, Duration limit);
    // The same, where the node is on another machine (grant_stream.hpp).
    LockStepEnd(std::unique_ptr<GrantStream> stream, Duration limit);
    ~LockStepEnd();

    // The conductor's: a page goes with the next message. A program that does not know pages keeps to the socket.
    void offer_page();
    // False: the other end is gone.
    bool send(LockStepMessage message);
    enum class Silence { kLate, kGone, kInterrupted };
    // Throws Error (network) if it is no message of this version.
    std::optional<LockStepMessage> receive();
    Silence silence() const { return silence_; }  // why receive() gave nothing

  private:
    bool send_by_socket(const LockStepMessage& message);
    ssize_t receive_by_socket(LockStepMessage& message);
    ssize_t receive_by_page(LockStepMessage& message);
    ssize_t receive_within_limit(LockStepMessage& message);
    bool has_ended() const;
    void map(int page);

    std::unique_ptr<GrantStream> stream_;  // null: the socket
    int descriptor_ = -1;
    Duration limit_;
    Silence silence_ = Silence::kGone;
    bool conductor_ = false, by_page_ = false;
    int offered_ = -1;
    LockStepPage* page_ = nullptr;  // null: the socket alone
    LockStepPage::Slot *out_ = nullptr, *in_ = nullptr;
    std::uint32_t heard_ = 0;
};

// Answers each grant with a tick, after those that want no answer, until another order comes, which it returns; none
// if the conductor is gone or a signal ends the program. Throws Error (network) if a datagram does not come.
// `quiet_until`, which may be empty: for each answer.
std::optional<LockStepMessage> run_in_lock_step(LockStepEnd& conductor, Process& process, Sockets& sockets,
                                                const std::function<SessionTime()>& quiet_until = {});

}  // namespace thimble
