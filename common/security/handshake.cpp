#include "common/security/handshake.hpp"

#include <algorithm>
#include <cstring>
#include <sodium.h>
#include <string_view>

#include "common/security/keyed_hash.hpp"

namespace thimble {
namespace {

constexpr std::size_t kCodeBytes = 16;
constexpr std::size_t kOwnAt = kSealHeaderBytes, kOtherAt = kOwnAt + 32, kCodeAt = kOtherAt + 32,
                      kProofAt = kCodeAt + kCodeBytes;
static_assert(kProofAt + kCodeBytes == kHandshakeBytes);

using Code = std::array<std::uint8_t, kCodeBytes>;

Code code_of(std::span<const std::uint8_t> key, std::string_view label, Bytes said) {
    Code code{};
    KeyedHash(key, code.size()).add(label).add(said).finish(code);
    return code;
}

Code lab_code(const LabKey& lab, Bytes datagram) {
    return code_of(lab.bytes(), "thimble-1 handshake", datagram.first(kCodeAt));
}

Code proof_code(const SecretKey& proof, Bytes datagram) {
    return code_of(proof.bytes, "thimble-1 proof", datagram.first(kCodeAt));
}

SecretKey derive(std::span<const std::uint8_t> secret, std::string_view label) {
    SecretKey key;
    KeyedHash(secret, kKeyBytes).add(label).finish(key.bytes);
    return key;
}

}  // namespace

OneTimeKey make_one_time_key(const RandomBytes& random) {
    OneTimeKey key;
    random(key.secret.bytes);
    crypto_scalarmult_base(key.open.data(), key.secret.bytes.data());
    return key;
}

HandshakeBytes write_handshake(const LabKey& lab, const HandshakeMessage& message, const SecretKey* proof) {
    HandshakeBytes bytes{};
    write_seal_header({message.kind, message.port, 0, 0}, std::span(bytes).first<kSealHeaderBytes>());
    std::copy(message.own.begin(), message.own.end(), bytes.begin() + kOwnAt);
    std::copy(message.other.begin(), message.other.end(), bytes.begin() + kOtherAt);
    const Code code = lab_code(lab, bytes);
    std::copy(code.begin(), code.end(), bytes.begin() + kCodeAt);
    if (proof == nullptr) return bytes;
    const Code proven = proof_code(*proof, bytes);
    std::copy(proven.begin(), proven.end(), bytes.begin() + kProofAt);
    return bytes;
}

std::optional<HandshakeMessage> read_handshake(const LabKey& lab, Port port, Bytes datagram) {
    const auto header = read_seal_header(datagram);
    if (!header || header->port != port || datagram.size() != kHandshakeBytes) return std::nullopt;
    if (!is_handshake(header->kind)) return std::nullopt;
    if (!same_bytes(lab_code(lab, datagram), datagram.subspan(kCodeAt, kCodeBytes))) return std::nullopt;
    // Where nothing is proven there is nothing that could be changed on the way.
    const Bytes proof = datagram.subspan(kProofAt, kCodeBytes);
    const auto is_zero = [](std::uint8_t byte) { return byte == 0; };
    if (header->kind != PacketKind::kAccept && !std::all_of(proof.begin(), proof.end(), is_zero))
        return std::nullopt;
    HandshakeMessage message{header->kind, header->port, {}, {}};
    std::copy_n(datagram.begin() + kOwnAt, message.own.size(), message.own.begin());
    std::copy_n(datagram.begin() + kOtherAt, message.other.size(), message.other.begin());
    return message;
}

bool proof_holds(const SecretKey& proof, Bytes datagram) {
    return datagram.size() == kHandshakeBytes &&
           same_bytes(proof_code(proof, datagram), datagram.subspan(kProofAt, kCodeBytes));
}

std::optional<AgreedKeys> agree(const LabKey& lab, const HandshakeParties& parties, const SecretKey& own,
                                const PublicKey& theirs) {
    SecretKey shared;
    if (crypto_scalarmult(shared.bytes.data(), own.bytes.data(), theirs.data()) != 0) return std::nullopt;
    std::array<std::uint8_t, 64> secret{};
    KeyedHash(lab.bytes(), secret.size())
        .add("thimble-1 session")
        .add(parties.initiator)
        .add(parties.responder)
        .add(parties.initiator_key)
        .add(parties.responder_key)
        .add(shared.bytes)
        .finish(secret);
    AgreedKeys keys{derive(secret, "initiator to responder"), derive(secret, "responder to initiator"),
                    derive(secret, "proof")};
    wipe(secret);
    return keys;
}

SecretKey flow_key(const SecretKey& epoch_secret, const KeyedFlow& keyed) {
    SecretKey key;
    KeyedHash(epoch_secret.bytes, kKeyBytes)
        .add(keyed.hop ? "thimble-1 hop " : "thimble-1 flow ")
        .add(to_string(speaker(keyed)))
        .add(" -> ")
        .add(to_string(owner(keyed.port)))
        .add(": ")
        .add(flow(keyed.port).what)
        .add(keyed.port)
        .finish(key.bytes);
    return key;
}

LabKey key_of_rig(const LabKey& key, std::string_view rig) {
    SecretKey bound;
    KeyedHash(key.bytes(), kKeyBytes).add("thimble-1 rig ").add(rig).finish(bound.bytes);
    return LabKey(bound.bytes);
}

}  // namespace thimble
