// Grants to programs on other machines (docs/clocks.md): over TCP. Only a program that has the run's key is let in, and each
// message carries a mark that only this key makes.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <sys/types.h>

#include <boost/core/noncopyable.hpp>

#include "common/network_settings.hpp"
#include "common/runtime/lock_step.hpp"
#include "common/security/secret.hpp"
#include "common/text_file.hpp"

namespace thimble {

// The launcher gives a node the run's key in this variable, as hexadecimal digits.
inline constexpr const char* kGrantKeyVariable = "THIMBLE_GRANT_KEY";
SecretKey read_grant_key(const std::string& digits);  // throws Error (usage)
std::string grant_key_text(const SecretKey& key);

using GrantMark = std::array<std::uint8_t, 32>;

// One end of a connection. Its peer has the key, or no message of the peer is taken.
class GrantStream : boost::noncopyable {
  public:
    // A node's. Throws Error (network) if no conductor listens there.
    static std::unique_ptr<GrantStream> to_conductor(const Endpoint& conductor, const SecretKey& key,
                                                     const std::string& program);

    // False: the other end is gone.
    bool send(const LockStepMessage& message);
    // As recv(2): 0 if the other end is gone, -1 if nothing has come. Throws Error (network) if the mark is not right, or if
    // the conductor ends before its first order to this node.
    ssize_t receive(LockStepMessage& message);
    // The node names it: "thimble-netem".
    const std::string& program() const { return program_; }

  private:
    friend class GrantDoor;
    struct Hello;
    struct Marked;
    enum class Sender : std::uint8_t { kConductor, kNode };

    // Takes the descriptor.
    GrantStream(int descriptor, Sender self);
    bool prove(const SecretKey& key, const std::string& program);
    // The conductor's half, which never waits: it asks once, then looks again and again for the proof.
    enum class Standing { kUnproved, kProved, kTurnedAway };
    bool ask();
    Standing admit(const SecretKey& key);
    // As recv(2), but -1 until all bytes have come.
    ssize_t gather(std::size_t wanted, int flags);
    void agree(const SecretKey& key, const Hello& hello);
    void mark(Marked& marked, Sender sender, std::uint64_t number) const;

    FileDescriptor descriptor_;
    Sender self_;
    std::string program_;
    SecretKey key_;  // of this connection
    GrantMark asked_{};
    SessionTime prove_until_{};
    std::array<std::uint8_t, 128> came_{};
    std::size_t came_bytes_ = 0;
    std::uint64_t sent_ = 0, received_ = 0;
};

// The conductor's port for the nodes of other machines, with a key for this run alone.
class GrantDoor : boost::noncopyable {
  public:
    // Throws Error (network) if the port is taken.
    explicit GrantDoor(const Endpoint& here);

    const SecretKey& key() const { return key_; }
    // Of a node that has proved the key; null: none has. It never waits. Each program that connects has 1 s to prove the key,
    // beside all others.
    std::unique_ptr<GrantStream> take();

  private:
    void accept_all();

    FileDescriptor descriptor_;
    SecretKey key_;
    std::deque<std::unique_ptr<GrantStream>> unproved_{};  // oldest first
};

}  // namespace thimble
