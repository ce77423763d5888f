#include "common/security/key_message.hpp"

#include <algorithm>

#include "common/security/byte_order.hpp"

namespace thimble {
namespace {

constexpr std::uint8_t kGrant = 1, kReceipt = 2;
constexpr std::size_t kGrantHead = 1 + 8 + 4 + 1 + 1, kFlowKeyBytes = 1 + kKeyBytes;
static_assert(kGrantHead + kMostFlowKeys * kFlowKeyBytes <= kMaxSealedTextBytes);

}  // namespace

Bytes write_grant(const KeyGrant& grant, KeyText& out) {
    out[0] = kGrant;
    write_little_endian(grant.session, &out[1]);
    write_little_endian(grant.epoch, &out[9]);
    out[13] = grant.in_use ? 1 : 0;
    out[14] = static_cast<std::uint8_t>(grant.count);
    std::uint8_t* at = &out[kGrantHead];
    for (std::size_t i = 0; i < grant.count; ++i, at += kFlowKeyBytes) {
        *at = static_cast<std::uint8_t>(grant.keys[i].port);
        std::copy(grant.keys[i].key.bytes.begin(), grant.keys[i].key.bytes.end(), at + 1);
    }
    return Bytes(out).first(kGrantHead + grant.count * kFlowKeyBytes);
}

std::optional<KeyGrant> read_grant(Bytes text) {
    if (text.size() < kGrantHead || text[0] != kGrant || text[13] > 1 || text[14] > kMostFlowKeys)
        return std::nullopt;
    KeyGrant grant;
    grant.session = read_little_endian<std::uint64_t>(&text[1]);
    grant.epoch = read_little_endian<std::uint32_t>(&text[9]);
    grant.in_use = text[13] == 1;
    grant.count = text[14];
    if (text.size() != kGrantHead + grant.count * kFlowKeyBytes) return std::nullopt;
    const std::uint8_t* at = text.data() + kGrantHead;
    for (std::size_t i = 0; i < grant.count; ++i, at += kFlowKeyBytes) {
        if (*at >= kPortCount) return std::nullopt;
        grant.keys[i].port = static_cast<Port>(*at);
        std::copy_n(at + 1, kKeyBytes, grant.keys[i].key.bytes.begin());
    }
    return grant;
}

Bytes write_receipt(const KeyReceipt& receipt, KeyText& out) {
    out[0] = kReceipt;
    write_little_endian(receipt.epoch, &out[1]);
    out[5] = receipt.in_use ? 1 : 0;
    return Bytes(out).first(6);
}

std::optional<KeyReceipt> read_receipt(Bytes text) {
    if (text.size() != 6 || text[0] != kReceipt || text[5] > 1) return std::nullopt;
    return KeyReceipt{read_little_endian<std::uint32_t>(&text[1]), text[5] == 1};
}

}  // namespace thimble
