#include "common/security/secure_pair.hpp"

#include <algorithm>
#include <utility>

#include "common/security/sealing.hpp"

namespace thimble {
namespace {

// Then it starts again: the offer may be of a session that is gone. The keys stay, because the answer may still be
// under way.
constexpr int kMostAccepts = 3;
constexpr Duration kForeignAnswerPeriod = std::chrono::milliseconds{250};

}  // namespace

SecurePair::SecurePair(Channel& wire, const LabKey& lab, const Ends& ends, RandomBytes random,
                       const SecurityTimes& times)
    : wire_(&wire),
      lab_(&lab),
      ends_(ends),
      random_(std::move(random)),
      times_(times),
      begins_(owner(ends.remote) == Role::kSession) {
    if (!begins_) own_ = make_one_time_key(random_);
}

void SecurePair::tick(SessionTime now) {
    now_ = now;
    if (established() && now - established_at_ > times_.grace) in_.before.disarm();
    if (!begins_) return;
    if (!trying_ && needs_handshake()) begin();
    if (trying_ && now >= next_send_) speak();
}

bool SecurePair::needs_handshake() const {
    return !established() || renewal_wanted_ || silent(now_) ||
           now_ - established_at_ >= times_.renew_after || out_.packets() >= times_.renew_packets;
}

SessionTime SecurePair::next_wakeup() const {
    if (!begins_) return kNever;
    if (trying_ || !established()) return next_send_;
    return std::min(heard_ + times_.silent + Duration{1}, established_at_ + times_.renew_after);
}

void SecurePair::begin() {
    own_ = make_one_time_key(random_);
    pending_ = {};
    trying_ = true;
    renewal_wanted_ = false;
    next_send_ = now_;
}

void SecurePair::speak() {
    next_send_ = now_ + times_.resend;
    const bool accepts = pending_.valid && accepts_sent_ < kMostAccepts;
    accepts_sent_ = accepts ? accepts_sent_ + 1 : 0;
    if (!accepts) return transmit({PacketKind::kHello, ends_.remote, own_.open, {}});
    transmit({PacketKind::kAccept, ends_.remote, own_.open, pending_.other}, &pending_.keys.proof);
}

void SecurePair::transmit(const HandshakeMessage& message, const SecretKey* proof) {
    wire_->send(write_handshake(*lab_, message, proof));
}

void SecurePair::send_sealed(PacketKind kind, Bytes text) {
    const Bytes datagram = out_.seal(kind, ends_.remote, text);
    ++(datagram.empty() ? counters_.not_sent : counters_.sealed);
    if (!datagram.empty()) wire_->send(datagram);
}

Bytes SecurePair::take() {
    return receive_judged(*wire_, [this](Bytes datagram) { return judge(datagram); });
}

// The message for the channel's reader. Empty: the datagram was part of the handshake, or refused.
Bytes SecurePair::judge(Bytes datagram) {
    const auto header = read_seal_header(datagram);
    if (!header) {
        ++counters_.unsealed;
    } else if (is_handshake(header->kind)) {
        take_handshake(datagram);
    } else if (header->port != ends_.local || header->kind == PacketKind::kHop) {
        ++counters_.wrong_role;
    } else {
        return open_sealed(*header, datagram);
    }
    return {};
}

Bytes SecurePair::open_sealed(const SealHeader& header, Bytes datagram) {
    const bool proves = pending_.valid && pending_.opener.knows(header);
    Opener* const opener = proves ? &pending_.opener : in_.find(header);
    // Only the newest handshake may carry grants: a delayed one must not bring old keys back.
    const bool too_old = opener == &in_.before && header.kind == PacketKind::kKeys;
    if (opener == nullptr || too_old) {
        ++counters_.no_key;
        return {};
    }
    const auto size = opener->open(header, datagram, text_, counters_);
    if (!size) return {};
    heard_ = now_;
    if (opener == &in_.now && opener->is_newest(header)) wire_->follow();
    if (proves) {  // the first message under the new keys: the peer has them
        in_.before = in_.now;
        in_.now = pending_.opener;
        establish(pending_.keys.initiator_to_responder);
    }
    const Bytes text{text_.data(), *size};
    if (header.kind == PacketKind::kData) return open_ ? text : Bytes{};
    if (keys_hook_) keys_hook_(text);
    wipe(text_);
    return {};
}

void SecurePair::take_handshake(Bytes datagram) {
    if (datagram.size() != kHandshakeBytes) {  // an answer to it could be longer than it is
        ++counters_.handshake_refused;
        return;
    }
    const auto message = read_handshake(*lab_, ends_.local, datagram);
    if (!message) return answer_foreign(read_seal_header(datagram)->kind);
    foreign_key_heard_ = false;
    if (!begins_ && message->kind == PacketKind::kHello) return take_hello(*message);
    if (!begins_ && message->kind == PacketKind::kAccept) return take_accept(*message, datagram);
    if (begins_ && message->kind == PacketKind::kOffer) return take_offer(*message);
    ++counters_.handshake_refused;
}

// A peer with another lab key learns from our offer, which it refuses, that this end exists. Four times a second at
// most, and no secret is used for it that an answer would not show anyway.
void SecurePair::answer_foreign(PacketKind kind) {
    ++counters_.handshake_refused;
    foreign_key_heard_ = true;
    if (begins_ || kind != PacketKind::kHello || now_ < next_foreign_answer_) return;
    next_foreign_answer_ = now_ + kForeignAnswerPeriod;
    transmit({PacketKind::kOffer, ends_.remote, own_.open, {}});
}

// Nothing is remembered of it: it may be a recording.
void SecurePair::take_hello(const HandshakeMessage& hello) {
    wire_->send_back(
        write_handshake(*lab_, {PacketKind::kOffer, ends_.remote, own_.open, hello.own}, nullptr));
}

void SecurePair::take_offer(const HandshakeMessage& offer) {
    if (!trying_ || offer.other != own_.open) {
        ++counters_.handshake_refused;
        return;
    }
    if (pending_.valid && pending_.other == offer.own) return;  // said twice; the timer repeats our answer
    const auto keys = agree(*lab_, parties(offer.own), own_.secret, offer.own);
    if (!keys) {
        ++counters_.handshake_refused;
        return;
    }
    pending_.valid = true;
    pending_.other = offer.own;
    pending_.keys = *keys;
    pending_.opener.arm(keys->responder_to_initiator);
    accepts_sent_ = 0;
    speak();
}

void SecurePair::take_accept(const HandshakeMessage& accept, Bytes datagram) {
    if (established() && accept.own == peer_key_ && accept.other == agreed_own_) {
        send_sealed(PacketKind::kKeys, {});  // our first message was lost
        return;
    }
    std::optional<AgreedKeys> keys;
    if (accept.other == own_.open) keys = agree(*lab_, parties(accept.own), own_.secret, accept.own);
    if (!keys || !proof_holds(keys->proof, datagram)) {
        ++counters_.handshake_refused;
        return;
    }
    wire_->follow();
    peer_key_ = accept.own;
    agreed_own_ = own_.open;
    own_ = make_one_time_key(random_);  // each is used once
    in_.before = in_.now;
    in_.now.arm(keys->initiator_to_responder);
    establish(keys->responder_to_initiator);
    heard_ = now_;
    send_sealed(PacketKind::kKeys, {});
}

HandshakeParties SecurePair::parties(const PublicKey& theirs) const {
    if (begins_) return {ends_.local, ends_.remote, own_.open, theirs};
    return {ends_.remote, ends_.local, theirs, own_.open};
}

void SecurePair::establish(const SecretKey& out) {
    out_.arm(out);
    ++generation_;
    ++counters_.handshakes;
    established_at_ = now_;
    trying_ = false;
    pending_ = {};
    if (begins_) own_ = {};
}

PairTrouble SecurePair::trouble() const {
    if (established() && !silent(now_)) return PairTrouble::kNone;
    if (foreign_key_heard_) return PairTrouble::kWrongLabKey;
    return counters_.unsealed > 0 ? PairTrouble::kUnsealed : PairTrouble::kSilent;
}

}  // namespace thimble
