// Two programs with the same lab key agree on session keys: X25519 between one-time keys of both sides, mixed with
// the lab key by keyed BLAKE2b over all messages. Three messages of one length, and the first sealed datagram as the
// fourth:
//
//   hello   initiator -> responder   its one-time public key
//   offer   responder -> initiator   its own, and the initiator's again
//   accept  initiator -> responder   both, and a proof that it has the keys that follow from them
//
// Each has a code under the lab key, so a flood costs one keyed hash per datagram. Only an answer to a fresh
// offer costs an X25519. docs/security.md lists the consequences.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "common/security/flow_roles.hpp"
#include "common/security/sealing.hpp"

namespace thimble {

using PublicKey = std::array<std::uint8_t, 32>;

// One side's one-time key.
struct OneTimeKey {
    SecretKey secret;
    PublicKey open{};
};
OneTimeKey make_one_time_key(const RandomBytes& random);

struct HandshakeMessage {
    PacketKind kind = PacketKind::kHello;
    Port port = Port::kCount;  // to which it is sent
    PublicKey own{}, other{};  // other: zero in a hello
};
inline constexpr std::size_t kHandshakeBytes = kSealHeaderBytes + 32 + 32 + 16 + 16;
using HandshakeBytes = std::array<std::uint8_t, kHandshakeBytes>;

// `proof`: the key that both compute, of an accept; none: zeros.
HandshakeBytes write_handshake(const LabKey& lab, const HandshakeMessage& message,
                               const SecretKey* proof = nullptr);
// None: it is not made under this lab key, not for this port, or none at all.
std::optional<HandshakeMessage> read_handshake(const LabKey& lab, Port port, Bytes datagram);
bool proof_holds(const SecretKey& proof, Bytes datagram);

struct AgreedKeys {
    SecretKey initiator_to_responder, responder_to_initiator, proof;
};
// The ports at which each side listens, and both public keys as the messages had them. None if `theirs` is no proper public
// key.
struct HandshakeParties {
    Port initiator = Port::kCount, responder = Port::kCount;
    PublicKey initiator_key{}, responder_key{};
};
std::optional<AgreedKeys> agree(const LabKey& lab, const HandshakeParties& parties, const SecretKey& own,
                                const PublicKey& theirs);

// The key of a one-way flow, from the secret of an epoch: names who may seal it, for whom, and what.
SecretKey flow_key(const SecretKey& epoch_secret, const KeyedFlow& keyed);

// The programs of a rig use this key in place of `key`, so they refuse every message of another rig. NetworkSettings::rig()
// gives `rig`.
LabKey key_of_rig(const LabKey& key, std::string_view rig);

}  // namespace thimble
