// Keys of one-way flows. The session makes them, a secret per epoch, and gives each node the keys of its own roles and
// directions (KeyServer); a node holds those (KeyRing). A new epoch begins with each handshake that a node has completed, so
// after each start of a node, and when handshakes are renewed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/security/sealing.hpp"
#include "common/security/secret.hpp"
#include "common/security/secure_flow.hpp"
#include "common/security/secure_pair.hpp"

namespace thimble {

// Messages between session and node about the keys of one-way flows, inside their secured control channel. Little endian.
struct FlowKey {
    KeyedFlow keyed;
    SecretKey key;
};
inline constexpr std::size_t kMostFlowKeys = 10;  // of one node

// Session to node: the keys of one epoch of one session. Not yet in use: the node opens with them, and seals as before.
struct KeyGrant {
    std::uint64_t session = 0;
    std::uint32_t epoch = 0;
    bool in_use = false;
    std::size_t count = 0;
    std::array<FlowKey, kMostFlowKeys> keys;
};
// Node to session: the grant has arrived and, if `in_use`, its keys are in use.
struct KeyReceipt {
    std::uint32_t epoch = 0;
    bool in_use = false;
};

using KeyText = std::array<std::uint8_t, kMaxSealedTextBytes>;
// Returns the part of `out` that is used.
Bytes write_grant(const KeyGrant& grant, KeyText& out);
std::optional<KeyGrant> read_grant(Bytes text);
Bytes write_receipt(const KeyReceipt& receipt, KeyText& out);
std::optional<KeyReceipt> read_receipt(Bytes text);

// The ends of flows that one program has.
struct FlowEnds {
    std::vector<SecureInlet*> inlets;
    std::vector<SecureOutlet*> outlets;

    // The receiving ends open with this key as well; the one before stays until forget_before().
    void expect(const KeyedFlow& keyed, const SecretKey& key) const;
    // The sending end seals with it from now on.
    void use(const KeyedFlow& keyed, const SecretKey& key) const;
    void forget_before() const;
    void forget_all() const;
    std::uint64_t most_packets() const;  // sealed under one key
};

class KeyRing {
  public:
    KeyRing(FlowEnds& ends, SecurePair& control, const SecurityTimes& times);
    void tick(SessionTime now);

  private:
    void take(const KeyGrant& grant);

    FlowEnds* ends_;
    SecurePair* control_;
    SecurityTimes times_;
    SessionTime now_{}, forget_at_ = kNever, next_renewal_{};
    bool holds_ = false;
    KeyGrant grant_;
    KeyText text_{};
};

class KeyServer {
  public:
    KeyServer(FlowEnds& ends, RandomBytes random, const SecurityTimes& times);
    // Before the first tick. Its data are let in once the node has all its keys.
    void serve(SecurePair& control);
    void tick(SessionTime now);
    SessionTime next_wakeup() const;
    // Each of these nodes has its keys.
    bool complete() const;

  private:
    struct Member {
        SecurePair* pair = nullptr;
        std::uint32_t generation = 0;
        std::uint32_t first_epoch = 0;  // that it may be given
        KeyReceipt receipt{};
        bool receipt_valid = false;
    };

    void look_for_handshakes();
    void begin_epoch();
    void use_epoch();
    void tell();
    bool may_have(const Member& member) const {
        return member.generation > 0 && member.first_epoch <= epoch_;
    }
    bool has(const Member& member, bool in_use) const;
    bool all_expect() const;

    FlowEnds* ends_;
    RandomBytes random_;
    SecurityTimes times_;
    std::vector<Member> members_;
    SessionTime now_{}, begun_{}, next_tell_ = kNever, forget_at_ = kNever;
    std::uint64_t session_ = 0;
    std::uint32_t epoch_ = 0;
    bool wanted_ = false, in_use_ = true;
    SecretKey secret_;
    KeyText text_{};
};

}  // namespace thimble
