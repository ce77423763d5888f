// A channel with a way back, protected: one handshake, then every datagram sealed. The node's end begins the handshake, again
// whenever its peer has been silent, and when its keys are old; the session's end answers.
#pragma once

#include <functional>

#include "common/security/handshake.hpp"
#include "common/security/sealing.hpp"

namespace thimble {

struct SecurityTimes {
    Duration resend = std::chrono::milliseconds{100};  // of a handshake's message
    Duration silent = std::chrono::milliseconds{300};  // then the peer may have been started anew
    Duration renew_after = std::chrono::hours{1};      // a new handshake, and with it new keys of every flow
    std::uint64_t renew_packets = std::uint64_t{1} << 32U;  // likewise
    Duration grace = std::chrono::seconds{1};               // for what is under way under the keys before
    Duration agreed_within =
        std::chrono::milliseconds{250};  // new flow keys are used then, even without confirmation
};

enum class PairTrouble { kNone, kSilent, kWrongLabKey, kUnsealed };

class SecurePair final : public Channel {
  public:
    struct Ends {
        Port local = Port::kCount, remote = Port::kCount;
    };
    // For messages about keys, beside the data.
    using KeysHook = std::function<void(Bytes text)>;

    // `wire` and `lab` outlive it. The end at the session answers, the other begins.
    SecurePair(Channel& wire, const LabKey& lab, const Ends& ends, RandomBytes random,
               const SecurityTimes& times);

    // What is due. Receiving and sending then happen at this `now`.
    void tick(SessionTime now);
    SessionTime next_wakeup() const;

    void send(Bytes datagram) override { send_sealed(PacketKind::kData, datagram); }
    std::optional<SessionTime> arrival() const override { return wire_->arrival(); }

    void send_keys(Bytes text) { send_sealed(PacketKind::kKeys, text); }
    void set_keys_hook(KeysHook hook) { keys_hook_ = std::move(hook); }
    // Data that comes in while the pair is closed are thrown away: the peer has not all its keys yet.
    void set_open(bool open) { open_ = open; }
    // How many handshakes have been completed: another number is another life, or other keys, of the peer.
    std::uint32_t generation() const { return generation_; }
    bool established() const { return out_.armed(); }
    bool silent(SessionTime now) const { return now - heard_ > times_.silent; }
    // As InboundFlow::did_not_listen().
    void did_not_listen(Duration time) { heard_ += time; }
    void renew() { renewal_wanted_ = true; }
    Role peer() const { return owner(ends_.remote); }
    // The reason for missing keys, for messages to the user only.
    PairTrouble trouble() const;
    const SecurityCounters& counters() const { return counters_; }

  private:
    struct Pending {  // keys that the other side may not have yet
        bool valid = false;
        PublicKey other{};
        AgreedKeys keys;
        Opener opener;
    };

    Bytes take() override;
    Bytes judge(Bytes datagram);
    Bytes open_sealed(const SealHeader& header, Bytes datagram);
    void take_handshake(Bytes datagram);
    void answer_foreign(PacketKind kind);
    void take_hello(const HandshakeMessage& hello);
    void take_offer(const HandshakeMessage& offer);
    void take_accept(const HandshakeMessage& accept, Bytes datagram);
    void begin();
    void speak();
    void send_sealed(PacketKind kind, Bytes text);
    void establish(const SecretKey& out);
    bool needs_handshake() const;
    HandshakeParties parties(const PublicKey& theirs) const;
    void transmit(const HandshakeMessage& message, const SecretKey* proof = nullptr);

    Channel* wire_;
    const LabKey* lab_;
    Ends ends_;
    RandomBytes random_;
    SecurityTimes times_;
    bool begins_;
    bool open_ = true;
    bool trying_ = false;  // of the end that begins
    bool renewal_wanted_ = false;
    bool foreign_key_heard_ = false;
    int accepts_sent_ = 0;
    std::uint32_t generation_ = 0;
    SessionTime now_{}, next_send_{}, heard_{}, established_at_{}, next_foreign_answer_{};
    OneTimeKey own_;
    PublicKey peer_key_{}, agreed_own_{};  // of the keys that hold, at the end that answers
    Pending pending_;
    OpenerPair in_;
    Sealer out_;
    KeysHook keys_hook_;
    SecurityCounters counters_;
    alignas(16) std::array<std::uint8_t, kMaxDatagramBytes> text_{};
};

}  // namespace thimble
