#include "common/security/key_ring.hpp"

#include <algorithm>

#include "common/security/flow_roles.hpp"
#include "common/security/keyed_hash.hpp"

namespace thimble {

namespace {

constexpr std::uint8_t kGrant = 1, kReceipt = 2;
constexpr std::uint8_t kHopBit = 0x80;  // beside the port
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
        const KeyedFlow& keyed = grant.keys[i].keyed;
        at[0] = static_cast<std::uint8_t>(static_cast<std::uint8_t>(keyed.port) | (keyed.hop ? kHopBit : 0));
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
        const auto port = static_cast<std::uint8_t>(*at & ~kHopBit);
        if (port >= kPortCount) return std::nullopt;
        grant.keys[i].keyed = {static_cast<Port>(port), (*at & kHopBit) != 0};
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

namespace {

constexpr Duration kTellPeriod = std::chrono::milliseconds{50};

}  // namespace

void FlowEnds::expect(const KeyedFlow& keyed, const SecretKey& key) const {
    for (SecureInlet* inlet : inlets) {
        if (inlet->keyed() != keyed) continue;
        inlet->openers().before = inlet->openers().now;
        inlet->openers().now.arm(key);
    }
}

void FlowEnds::use(const KeyedFlow& keyed, const SecretKey& key) const {
    for (SecureOutlet* outlet : outlets) {
        if (outlet->keyed() == keyed) outlet->sealer().arm(key);
    }
}

void FlowEnds::forget_before() const {
    for (SecureInlet* inlet : inlets) inlet->openers().before.disarm();
}

void FlowEnds::forget_all() const {
    for (SecureInlet* inlet : inlets) inlet->openers() = {};
    for (SecureOutlet* outlet : outlets) outlet->sealer().disarm();
}

std::uint64_t FlowEnds::most_packets() const {
    std::uint64_t most = 0;
    for (SecureOutlet* outlet : outlets) most = std::max(most, outlet->sealer().packets());
    return most;
}

KeyRing::KeyRing(FlowEnds& ends, SecurePair& control, const SecurityTimes& times)
    : ends_(&ends), control_(&control), times_(times) {
    control_->set_keys_hook([this](Bytes text) {
        if (const auto grant = read_grant(text)) take(*grant);
    });
}

void KeyRing::tick(SessionTime now) {
    now_ = now;
    if (now >= forget_at_) {
        ends_->forget_before();
        forget_at_ = kNever;
    }
    if (ends_->most_packets() < times_.renew_packets || now < next_renewal_) return;
    control_->renew();
    next_renewal_ = now + times_.grace;  // the new keys are on their way
}

// The session repeats a grant until it has the receipt. Grants of earlier epochs are refused: they may be replays.
void KeyRing::take(const KeyGrant& grant) {
    const bool other_session = !holds_ || grant.session != grant_.session;
    if (!other_session && grant.epoch < grant_.epoch) return;
    const bool fresh = other_session || grant.epoch > grant_.epoch;
    if (other_session) ends_->forget_all();
    if (fresh) forget_at_ = kNever;  // the keys before are now those in use
    for (std::size_t i = 0; i < grant.count; ++i) {
        const FlowKey& one = grant.keys[i];
        if (fresh) ends_->expect(one.keyed, one.key);
        if (grant.in_use && (fresh || !grant_.in_use)) ends_->use(one.keyed, one.key);
    }
    const bool in_use = grant.in_use || (!fresh && grant_.in_use);
    if (grant.in_use && (fresh || !grant_.in_use)) forget_at_ = now_ + times_.grace;
    holds_ = true;
    grant_.session = grant.session;
    grant_.epoch = grant.epoch;
    grant_.in_use = in_use;
    control_->send_keys(write_receipt({grant_.epoch, in_use}, text_));
}

KeyServer::KeyServer(FlowEnds& ends, RandomBytes random, const SecurityTimes& times)
    : ends_(&ends), random_(std::move(random)), times_(times) {
    std::array<std::uint8_t, sizeof session_> bytes{};
    random_(bytes);
    for (const std::uint8_t byte : bytes) session_ = session_ << 8U | byte;
}

void KeyServer::serve(SecurePair& control) {
    control.set_open(false);
    const std::size_t index = members_.size();
    members_.push_back({&control});
    control.set_keys_hook([this, index](Bytes text) {
        const auto receipt = read_receipt(text);
        if (!receipt) return;
        Member& member = members_[index];
        member.receipt = *receipt;
        member.receipt_valid = true;
        if (may_have(member) && has(member, true)) member.pair->set_open(true);
    });
}

void KeyServer::tick(SessionTime now) {
    now_ = now;
    if (now >= forget_at_) {
        ends_->forget_before();
        forget_at_ = kNever;
    }
    look_for_handshakes();
    if (!in_use_ && (all_expect() || now - begun_ >= times_.agreed_within)) use_epoch();
    if (wanted_ && in_use_) begin_epoch();
    if (now >= next_tell_) tell();
}

void KeyServer::look_for_handshakes() {
    for (Member& member : members_) {
        if (member.pair->generation() == member.generation) continue;
        member.generation = member.pair->generation();
        member.first_epoch = epoch_ + 1;
        member.receipt_valid = false;
        member.pair->set_open(false);
        wanted_ = true;
    }
}

void KeyServer::begin_epoch() {
    wanted_ = false;
    in_use_ = false;
    forget_at_ = kNever;  // the keys before are now those in use
    ++epoch_;
    random_(secret_.bytes);
    for (const KeyedFlow& keyed : kKeyedFlows) ends_->expect(keyed, flow_key(secret_, keyed));
    begun_ = now_;
    next_tell_ = now_;
}

void KeyServer::use_epoch() {
    in_use_ = true;
    for (const KeyedFlow& keyed : kKeyedFlows) ends_->use(keyed, flow_key(secret_, keyed));
    forget_at_ = now_ + times_.grace;
    next_tell_ = now_;
}

void KeyServer::tell() {
    next_tell_ = kNever;
    for (const Member& member : members_) {
        if (!may_have(member) || has(member, in_use_)) continue;
        KeyGrant grant;
        grant.session = session_;
        grant.epoch = epoch_;
        grant.in_use = in_use_;
        const Role role = member.pair->peer();
        for (const KeyedFlow& keyed : kKeyedFlows) {
            if (owner(keyed.port) != role && speaker(keyed) != role) continue;
            grant.keys[grant.count++] = {keyed, flow_key(secret_, keyed)};
        }
        member.pair->send_keys(write_grant(grant, text_));
        next_tell_ = now_ + kTellPeriod;
    }
    wipe(text_);
}

bool KeyServer::has(const Member& member, bool in_use) const {
    return member.receipt_valid && member.receipt.epoch == epoch_ && (member.receipt.in_use || !in_use);
}

bool KeyServer::all_expect() const {
    return std::all_of(members_.begin(), members_.end(), [this](const Member& member) {
        return !may_have(member) || has(member, false) || member.pair->silent(now_);
    });
}

bool KeyServer::complete() const {
    return !wanted_ && in_use_ && std::all_of(members_.begin(), members_.end(), [this](const Member& member) {
        return may_have(member) && has(member, true);
    });
}

SessionTime KeyServer::next_wakeup() const {
    SessionTime next = std::min(next_tell_, forget_at_);
    if (!in_use_) next = std::min(next, begun_ + times_.agreed_within);
    return wanted_ && in_use_ ? SessionTime{} : next;
}

}  // namespace thimble
