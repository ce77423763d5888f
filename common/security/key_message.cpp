#include "common/security/key_message.hpp"

#include <algorithm>

namespace thimble {
namespace {

constexpr std::uint8_t kGrant = 1, kReceipt = 2;
constexpr std::size_t kGrantHead = 1 + 8 + 4 + 1 + 1, kFlowKeyBytes = 1 + kKeyBytes;
static_assert(kGrantHead + kMostFlowKeys * kFlowKeyBytes <= kMaxSealedTextBytes);

template <class Number>
void put(Number number, std::uint8_t* out) {
    for (std::size_t i = 0; i < sizeof number; ++i) out[i] = static_cast<std::uint8_t>(number >> (8 * i));
}

template <class Number>
Number get(const std::uint8_t* in) {
    Number number = 0;
    for (std::size_t i = 0; i < sizeof number; ++i) number |= static_cast<Number>(Number{in[i]} << (8 * i));
    return number;
}

}  // namespace

Bytes write_grant(const KeyGrant& grant, KeyText& out) {
    out[0] = kGrant;
    put(grant.session, &out[1]);
    put(grant.epoch, &out[9]);
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
    grant.session = get<std::uint64_t>(&text[1]);
    grant.epoch = get<std::uint32_t>(&text[9]);
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
    put(receipt.epoch, &out[1]);
    out[5] = receipt.in_use ? 1 : 0;
    return Bytes(out).first(6);
}

std::optional<KeyReceipt> read_receipt(Bytes text) {
    if (text.size() != 6 || text[0] != kReceipt || text[5] > 1) return std::nullopt;
    return KeyReceipt{get<std::uint32_t>(&text[1]), text[5] == 1};
}

}  // namespace thimble
