// Keys of one-way flows. The session makes them, a secret per epoch, and gives each node the keys of its own roles and
// directions (KeyServer); a node holds those (KeyRing). A new epoch begins with each handshake that a node has completed, so
// after each start of a node, and when handshakes are renewed.
#pragma once

#include <vector>

#include "common/security/key_message.hpp"
#include "common/security/secure_flow.hpp"
#include "common/security/secure_pair.hpp"

namespace thimble {

// The ends of flows that one program has.
struct FlowEnds {
    std::vector<SecureInlet*> inlets;
    std::vector<SecureOutlet*> outlets;

    // The receiving ends open with this key as well; the one before stays until forget_before().
    void expect(Port port, const SecretKey& key) const;
    // The sending end seals with it from now on.
    void use(Port port, const SecretKey& key) const;
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
