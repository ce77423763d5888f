// The handshake in symbols: a public key is a number, and a code names the key that made it. The attacker has every message and no
// key. He can deliver any message to any end, at any time, or never.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/security/sealing.hpp"

namespace thimble::model {

// The code of a message covers these. False: a test leaves one out, and the attacker wins.
struct Bound {
    bool rig = true, role = true;
};

// A node and its session's end: of one rig, in one role.
struct Place {
    std::uint8_t rig = 0, role = 0;
};

// Both ends derive their keys from this.
struct Agreed {
    std::uint8_t lab = 0, role = 0, initiator = 0, responder = 0;
    auto operator<=>(const Agreed&) const = default;
};

// kKeys: the first sealed word, which shows that the sender has the keys.
struct Word {
    PacketKind kind = PacketKind::kHello;
    std::uint8_t lab = 0, role = 0;   // of the code, and of the port that it names
    std::uint8_t own = 0, other = 0;  // public keys
    Agreed proof{};                   // of an accept, and of the first sealed word
    auto operator<=>(const Word&) const = default;
};

// Public keys tell whose they are: so many for each place, the initiator's first.
inline constexpr std::uint8_t kKeysOfPlace = 16, kKeysOfEnd = 8;
constexpr std::uint8_t key_number(std::size_t place, bool initiator, std::uint8_t life) {
    return static_cast<std::uint8_t>(1 + place * kKeysOfPlace + (initiator ? 0 : kKeysOfEnd) + life);
}
constexpr std::size_t place_of(std::uint8_t key) { return (key - 1U) / kKeysOfPlace; }

// One end at a place. `own`, `pending`, `holds` are as in SecurePair; 0: none.
struct End {
    bool initiator = false;
    std::uint8_t place = 0, lab = 0, role = 0, life = 0,
                 most = kKeysOfEnd;  // one-time keys that it had, and may have
    std::uint8_t own = 0, pending = 0;
    Agreed holds{};

    // A new one-time key: of a new attempt, or of a program that was started anew.
    void renew(bool forgets) {
        own = life < most ? key_number(place, initiator, life++) : std::uint8_t{0};
        pending = 0;
        if (forgets) holds = {};
    }
    Word says(PacketKind kind, std::uint8_t other, const Agreed& proof = {}) const {
        return {kind, lab, role, own, other, proof};
    }
    Agreed with(std::uint8_t theirs) const {
        return initiator ? Agreed{lab, role, own, theirs} : Agreed{lab, role, theirs, own};
    }
    // What it answers.
    std::optional<Word> take(const Word& word) {
        return initiator ? take_as_node(word) : take_as_session(word);
    }

  private:
    bool made_here(const Word& word) const { return word.lab == lab && word.role == role; }

    std::optional<Word> take_as_node(const Word& word) {
        if (word.kind == PacketKind::kKeys && pending != 0 && word.proof == with(pending)) {
            holds = word.proof;
            own = pending = 0;
        }
        const bool fits = word.kind == PacketKind::kOffer && made_here(word) && own != 0 && word.other == own;
        if (!fits || word.own == pending) return std::nullopt;
        pending = word.own;
        return says(PacketKind::kAccept, pending, with(pending));
    }

    std::optional<Word> take_as_session(const Word& word) {
        if (word.kind == PacketKind::kHello && own != 0)
            return says(PacketKind::kOffer, made_here(word) ? word.own : std::uint8_t{0});
        if (word.kind != PacketKind::kAccept || !made_here(word)) return std::nullopt;
        const bool again = holds.lab != 0 && word.own == holds.initiator && word.other == holds.responder;
        if (again) return first_word();
        if (word.other != own || word.proof != with(word.own)) return std::nullopt;
        holds = word.proof;
        renew(false);
        return first_word();
    }
    Word first_word() const { return {PacketKind::kKeys, 0, 0, 0, 0, holds}; }
};

// A node's and a session's end at each place, in this order.
inline std::vector<End> ends_at(const std::vector<Place>& places, const Bound& bound,
                                std::uint8_t most = kKeysOfEnd) {
    std::vector<End> ends;
    ends.reserve(2 * places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        for (const bool initiator : {true, false}) {
            End end;
            end.initiator = initiator;
            end.most = most;
            end.place = static_cast<std::uint8_t>(i);
            end.lab = static_cast<std::uint8_t>(1 + (bound.rig ? places[i].rig : 0));
            end.role = bound.role ? places[i].role : std::uint8_t{0};
            end.renew(true);
            ends.push_back(end);
        }
    }
    return ends;
}

}  // namespace thimble::model
