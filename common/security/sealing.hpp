// One datagram, sealed: ChaCha20-Poly1305 (RFC 8439) with the counter as nonce, the header authenticated. Layout, little endian:
// 'T' '1' | kind, 1 byte | port, 1 | key's name, 4 | counter, 8 | text, as long as it was | tag, 16.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "common/channel.hpp"
#include "common/network_settings.hpp"
#include "common/security/secret.hpp"

namespace thimble {

// Which counters have been accepted: each at most once, none that is too old to know. The ring of RFC 6479.
class ReplayWindow {
  public:
    // The oldest counter that can still be judged, relative to the newest.
    static constexpr std::uint64_t kReach = 1984;

    // Counters begin with 1.
    bool is_fresh(std::uint64_t counter) const {
        if (counter == 0) return false;
        if (counter > newest_) return true;
        if (newest_ - counter >= kReach) return false;
        return (words_[word(counter)] >> (counter % kWordBits) & 1U) == 0;
    }
    // Of one that is fresh and proven: a forged counter must not move the window.
    void accept(std::uint64_t counter) {
        if (counter > newest_) {
            const std::uint64_t before = newest_ / kWordBits;
            const std::uint64_t cleared = std::min(counter / kWordBits - before, kWords);
            for (std::uint64_t i = 1; i <= cleared; ++i) words_[(before + i) % kWords] = 0;
            newest_ = counter;
        }
        words_[word(counter)] |= std::uint64_t{1} << (counter % kWordBits);
    }
    std::uint64_t newest() const { return newest_; }

  private:
    static constexpr std::uint64_t kWordBits = 64, kWords = 32;
    static_assert(kReach == (kWords - 1) * kWordBits);
    static std::size_t word(std::uint64_t counter) { return counter / kWordBits % kWords; }

    std::uint64_t newest_ = 0;
    std::array<std::uint64_t, kWords> words_{};
};

inline constexpr std::size_t kSealHeaderBytes = 16;
inline constexpr std::size_t kSealTagBytes = 16;
inline constexpr std::size_t kSealOverheadBytes = kSealHeaderBytes + kSealTagBytes;
inline constexpr std::size_t kMaxSealedTextBytes = kMaxDatagramBytes - kSealOverheadBytes;

// kHop: between relay and end of a flow, around a datagram that is sealed already. It gets a code and is not encrypted again.
enum class PacketKind : std::uint8_t { kData = 1, kKeys, kHello, kOffer, kAccept, kHop };
constexpr bool is_handshake(PacketKind kind) {
    return kind >= PacketKind::kHello && kind <= PacketKind::kAccept;
}

struct SealHeader {
    PacketKind kind = PacketKind::kData;
    // where the datagram is to be read in the end, or of a hop next: a flow's name, its direction and both its roles
    Port port = Port::kCount;
    std::uint32_t key_name = 0;  // which of the receiver's keys; says nothing about the key
    std::uint64_t counter = 0;   // from 1, per key
};
void write_seal_header(const SealHeader& header, std::span<std::uint8_t, kSealHeaderBytes> out);
// None: not one of ours.
std::optional<SealHeader> read_seal_header(Bytes datagram);

// Counts of datagrams that came in, and of those that went out or could not.
struct SecurityCounters {
    std::uint64_t sealed = 0, opened = 0;
    std::uint64_t forged = 0;             // the tag is wrong: changed on the way, or made without the key
    std::uint64_t replayed = 0;           // came before, or too old to know
    std::uint64_t wrong_role = 0;         // sealed for another flow, direction or role
    std::uint64_t no_key = 0;             // under a key that is not, or no longer, or not yet known here
    std::uint64_t unsealed = 0;           // not sealed at all
    std::uint64_t handshakes = 0;         // completed
    std::uint64_t handshake_refused = 0;  // not under our lab key, or not an answer to us
    std::uint64_t not_sent = 0;           // before there was a key, or too long to be sealed

    void add(const SecurityCounters& other);
};

// One direction's sending end. A key seals each counter once: never copy one that is in use.
class Sealer {
  public:
    // No datagram is sealed under one key beyond this; keys are renewed long before.
    static constexpr std::uint64_t kMostPackets = std::uint64_t{1} << 48U;

    void arm(const SecretKey& key);
    void disarm() { *this = Sealer{}; }
    bool armed() const { return armed_; }
    std::uint64_t packets() const { return counter_; }
    // Valid until the next call; empty if that cannot be sealed.
    Bytes seal(PacketKind kind, Port port, Bytes text);

  private:
    bool armed_ = false;
    SecretKey key_;
    std::uint32_t name_ = 0;
    std::uint64_t counter_ = 0;
    std::array<std::uint8_t, kMaxDatagramBytes> buffer_{};
};

// One direction's receiving end.
class Opener {
  public:
    void arm(const SecretKey& key);
    void disarm() { *this = Opener{}; }
    bool knows(const SealHeader& header) const { return armed_ && header.key_name == name_; }
    // Of a header that it has opened: none that was sent later has come.
    bool is_newest(const SealHeader& header) const { return header.counter == window_.newest(); }
    // Of a header that it knows: the text, in `out`; none: counted in `counters`.
    std::optional<std::size_t> open(const SealHeader& header, Bytes datagram,
                                    std::span<std::uint8_t, kMaxDatagramBytes> out,
                                    SecurityCounters& counters);

  private:
    bool armed_ = false;
    SecretKey key_;
    std::uint32_t name_ = 0;
    ReplayWindow window_;
};

// Two keys' receiving ends, the newer one and the one before.
struct OpenerPair {
    Opener now, before;
    Opener* find(const SealHeader& header) {
        if (now.knows(header)) return &now;
        return before.knows(header) ? &before : nullptr;
    }
};

// The next datagram of a wire that a judge lets through, as text; empty: none. A flood of what is refused must not hold a tick: the
// rest waits for the next one.
template <class Judge>
Bytes receive_judged(Channel& wire, Judge&& judge) {
    for (int refused = 0; refused < kMostRefusedAtOnce; ++refused) {
        const Bytes datagram = wire.receive();
        if (datagram.empty()) return {};
        const Bytes text = judge(datagram);
        if (!text.empty()) return text;
    }
    return {};
}

}  // namespace thimble
