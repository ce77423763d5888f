#include "common/security/sealing.hpp"

#include <algorithm>
#include <cstring>
#include <sodium.h>

#include "common/security/keyed_hash.hpp"

namespace thimble {
namespace {

constexpr std::array<std::uint8_t, 2> kMagic{'T', '1'};
static_assert(kSealTagBytes == crypto_aead_chacha20poly1305_ietf_ABYTES);
static_assert(kKeyBytes == crypto_aead_chacha20poly1305_ietf_KEYBYTES);

using Nonce = std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES>;

Nonce nonce_of(std::uint64_t counter) {
    Nonce nonce{};
    write_little_endian(counter, nonce.data() + 4);
    return nonce;
}

// How many bytes of the text stay readable; the tag covers them.
std::size_t readable(PacketKind kind, std::size_t size) { return kind == PacketKind::kHop ? size : 0; }

std::uint32_t name_of(const SecretKey& key) {
    constexpr const char* kLabel = "thimble-1 name of a key";
    std::array<std::uint8_t, crypto_generichash_BYTES_MIN> hash{};
    crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const std::uint8_t*>(kLabel),
                       std::strlen(kLabel), key.bytes.data(), key.bytes.size());
    return read_little_endian<std::uint32_t>(hash.data());
}

}  // namespace

void write_seal_header(const SealHeader& header, std::span<std::uint8_t, kSealHeaderBytes> out) {
    std::copy(kMagic.begin(), kMagic.end(), out.begin());
    out[2] = static_cast<std::uint8_t>(header.kind);
    out[3] = static_cast<std::uint8_t>(header.port);
    write_little_endian(header.key_name, &out[4]);
    write_little_endian(header.counter, &out[8]);
}

std::optional<SealHeader> read_seal_header(Bytes datagram) {
    if (datagram.size() < kSealOverheadBytes || datagram.size() > kMaxDatagramBytes) return std::nullopt;
    const bool known = datagram[2] >= static_cast<std::uint8_t>(PacketKind::kData) &&
                       datagram[2] <= static_cast<std::uint8_t>(PacketKind::kHop) && datagram[3] < kPortCount;
    if (!std::equal(kMagic.begin(), kMagic.end(), datagram.begin()) || !known) return std::nullopt;
    return SealHeader{static_cast<PacketKind>(datagram[2]), static_cast<Port>(datagram[3]),
                      read_little_endian<std::uint32_t>(&datagram[4]),
                      read_little_endian<std::uint64_t>(&datagram[8])};
}

void SecurityCounters::add(const SecurityCounters& other) {
    sealed += other.sealed;
    opened += other.opened;
    forged += other.forged;
    replayed += other.replayed;
    wrong_role += other.wrong_role;
    no_key += other.no_key;
    unsealed += other.unsealed;
    handshakes += other.handshakes;
    handshake_refused += other.handshake_refused;
    not_sent += other.not_sent;
}

void Sealer::arm(const SecretKey& key) {
    armed_ = true;
    key_ = key;
    name_ = name_of(key);
    counter_ = 0;
}

Bytes Sealer::seal(PacketKind kind, Port port, Bytes text) {
    if (!armed_ || text.size() > kMaxSealedTextBytes || counter_ >= kMostPackets) return {};
    write_seal_header({kind, port, name_, ++counter_}, std::span(buffer_).first<kSealHeaderBytes>());
    const std::size_t open = readable(kind, text.size()), covered = kSealHeaderBytes + open;
    std::copy_n(text.begin(), open, buffer_.begin() + kSealHeaderBytes);
    unsigned long long sealed = 0;
    const Nonce nonce = nonce_of(counter_);
    crypto_aead_chacha20poly1305_ietf_encrypt(buffer_.data() + covered, &sealed, text.data() + open,
                                              text.size() - open, buffer_.data(), covered, nullptr,
                                              nonce.data(), key_.bytes.data());
    return {buffer_.data(), covered + static_cast<std::size_t>(sealed)};
}

void Opener::arm(const SecretKey& key) {
    armed_ = true;
    key_ = key;
    name_ = name_of(key);
    window_ = {};
}

std::optional<std::size_t> Opener::open(const SealHeader& header, Bytes datagram,
                                        std::span<std::uint8_t, kMaxDatagramBytes> out,
                                        SecurityCounters& counters) {
    if (!window_.is_fresh(header.counter)) {
        ++counters.replayed;
        return std::nullopt;
    }
    const std::size_t open = readable(header.kind, datagram.size() - kSealOverheadBytes),
                      covered = kSealHeaderBytes + open;
    unsigned long long size = 0;
    const Nonce nonce = nonce_of(header.counter);
    if (crypto_aead_chacha20poly1305_ietf_decrypt(
            out.data() + open, &size, nullptr, datagram.data() + covered, datagram.size() - covered,
            datagram.data(), covered, nonce.data(), key_.bytes.data()) != 0) {
        ++counters.forged;
        return std::nullopt;
    }
    std::copy_n(datagram.begin() + kSealHeaderBytes, open, out.begin());
    window_.accept(header.counter);
    ++counters.opened;
    return open + static_cast<std::size_t>(size);
}

}  // namespace thimble
