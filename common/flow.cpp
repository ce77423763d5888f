#include "common/flow.hpp"

#include <cassert>
#include <numeric>

namespace thimble {
namespace {

// A sender that has been silent this long may be replaced by a restarted one.
constexpr Duration kReleaseAfter = std::chrono::seconds{1};

}  // namespace

std::uint64_t FlowCounters::refused_total() const {
    return std::accumulate(refused.begin(), refused.end(), std::uint64_t{0});
}

void FlowCounters::add(const FlowCounters& other) {
    accepted += other.accepted;
    for (std::size_t i = 0; i < refused.size(); ++i) refused[i] += other.refused[i];
}

// Both are called in admit() only, for each message: the compiler makes one function of them. With std::optional it would be longer.
inline Refusal InboundFlow::judge(SessionTime now, const Header& header) const {
    constexpr Refusal kNone = Refusal::kCount;
    if (header.sender != sender_) return Refusal::kUnexpectedKind;
    // Checked before the lock: leftovers of an earlier trial must not keep a restarted sender out.
    if (filter_ && (!running_ || header.trial != trial_)) return Refusal::kWrongTrial;
    if (!locked_) return kNone;
    if (header.instance != instance_) return now - heard_ > kReleaseAfter ? kNone : Refusal::kSecondSender;
    const std::int32_t ahead = sequence_ahead(header.sequence, newest_);
    if (ahead == 0) return Refusal::kDuplicate;
    if (ahead < 0) return Refusal::kOutdated;
    if (header.send_time < stamp_) return Refusal::kStampNotIncreasing;
    return kNone;
}

inline void InboundFlow::remember(SessionTime now, const Header& header) {
    locked_ = true;
    instance_ = header.instance;
    newest_ = header.sequence;
    stamp_ = header.send_time;
    heard_ = now;
    last_accepted_ = silent_since_ = now;
    ++counters_.accepted;
}

const Message* InboundFlow::admit(SessionTime now, Bytes datagram) {
    const std::optional<Refusal> refusal = decode_into(datagram, message_);
    if (!refusal) return admit(now, message_);
    ++counters_.refused[static_cast<std::size_t>(*refusal)];
    return nullptr;
}

const Message* InboundFlow::admit(SessionTime now, const Message& message) {
    if (const Refusal refusal = judge(now, message.header); refusal != Refusal::kCount) {
        ++counters_.refused[static_cast<std::size_t>(refusal)];
        return nullptr;
    }
    remember(now, message.header);
    return &message;
}

const Message* InboundFlow::take(SessionTime now, Channel& channel) {
    for (int refused = 0; refused < kMostRefusedAtOnce; ++refused) {
        const Message* message = nullptr;
        if (const SharedMessage* shared = channel.receive_shared()) {
            message = admit(now, shared->message);
        } else {
            const Bytes datagram = channel.receive();
            if (datagram.empty()) return nullptr;
            message = admit(now, datagram);
        }
        if (message != nullptr) return message;
    }
    return nullptr;
}

void InboundFlow::refuse_admitted(Refusal refusal) {
    --counters_.accepted;
    ++counters_.refused[static_cast<std::size_t>(refusal)];
}

OutboundFlow::OutboundFlow(Role sender, std::uint64_t instance, std::initializer_list<Channel*> channels)
    : sender_(sender), instance_(instance) {
    assert(channels.size() <= channels_.size());
    for (Channel* channel : channels) {
        channels_[channel_count_++] = channel;
        if (channel != nullptr && channel->pool() != nullptr) pool_ = channel->pool();
    }
}

void OutboundFlow::transmit(const Header& header, const Body& body) {
    const Bytes datagram = encoder_.encode(header, body);
    for (std::size_t i = 0; i < channel_count_; ++i) channels_[i]->send(datagram);
}

// A message that receivers refuse goes as bytes, so that each of them counts it.
void OutboundFlow::post(SharedMessage& shared, bool good) {
    for (std::size_t i = 0; i < channel_count_; ++i) {
        if (good && channels_[i]->pool() != nullptr) {
            channels_[i]->hand_over(shared);
        } else {
            channels_[i]->send(encoder_.encode(shared.message));
        }
    }
    pool_->release(shared);
}

}  // namespace thimble
