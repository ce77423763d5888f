#include "netem/link_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace thimble {
namespace {

constexpr std::uint32_t kNoSlot = UINT32_MAX;
// A normal deviate takes one number, rarely a few more (rejection): room enough that no packet uses its
// neighbour's.
constexpr std::uint64_t kNumbersPerDelay = 16;

}  // namespace

LinkCounters& LinkCounters::operator+=(const LinkCounters& other) {
    pushed += other.pushed;
    lost += other.lost;
    outage += other.outage;
    oversized += other.oversized;
    queue_full += other.queue_full;
    overflowed += other.overflowed;
    delivered += other.delivered;
    duplicated += other.duplicated;
    corrupted += other.corrupted;
    skipped += other.skipped;
    reordered += other.reordered;
    return *this;
}

LinkModel::LinkModel(const LinkSettings& settings, const StreamKey& key, std::uint32_t direction)
    : settings_(settings),
      direction_(direction),
      delay_stream_(stream_key(key, Purpose::kLinkDelay)),
      loss_stream_(stream_key(key, Purpose::kLinkLoss)),
      slots_(std::make_unique_for_overwrite<Slot[]>(settings.capacity)) {
    assert(settings.capacity > 0 && settings.capacity < kNoSlot);
    assert(settings.delay >= Duration::zero() && settings.jitter.spread >= Duration::zero());
    assert(stationary_loss(settings.loss) <= 1);
    if (!settings_.in_order) heap_.reserve(settings_.capacity);
    restart(key);
}

void LinkModel::restart(const StreamKey& key, SessionTime /*start*/) {
    delay_stream_ = RandomStream(stream_key(key, Purpose::kLinkDelay));
    loss_stream_ = RandomStream(stream_key(key, Purpose::kLinkLoss));
    heap_.clear();
    next_due_ = kNever;
    last_due_ns_ = INT64_MIN;
    in_flight_ = 0;
    free_ = kNoSlot;
    unused_ = 0;
    counters_ = {};
    delays_ = {};
}

// StreamKey has no field for the direction. An odd constant times a 32-bit number never repeats within 64
// bits.
StreamKey LinkModel::stream_key(const StreamKey& key, Purpose purpose) const {
    StreamKey mixed = key;
    mixed.study ^= 0x9E3779B97F4A7C15U * (std::uint64_t{direction_} + 1);
    mixed.purpose = purpose;
    return mixed;
}

void LinkModel::push(SessionTime now, Bytes datagram) {
    const std::uint64_t packet = counters_.pushed++;
    // One number for each packet, whatever becomes of it: nothing can shift the fates of those that follow.
    if (settings_.loss.probability > 0 && loss_stream_.uniform() < settings_.loss.probability) {
        ++counters_.lost;
        return drop(packet, now, DropReason::kLost);
    }
    if (datagram.empty() || datagram.size() > kMaxDatagramBytes) {
        ++counters_.oversized;
        return drop(packet, now, DropReason::kOversized);
    }
    if (in_flight_ == settings_.capacity) {
        ++counters_.overflowed;
        return drop(packet, now, DropReason::kOverflowed);
    }
    const std::uint32_t index = take_free_slot();
    Slot& slot = slots_[index];
    slot.packet = packet;
    slot.pushed_ns = to_nanoseconds(now);
    slot.due_ns = slot.pushed_ns + draw_delay_ns(packet);
    slot.size = static_cast<std::uint32_t>(datagram.size());
    std::memcpy(slot.bytes.data(), datagram.data(), datagram.size());
    if (settings_.in_order) {
        append(index);
    } else {
        insert(index, packet);
    }
}

void LinkModel::drop(std::uint64_t packet, SessionTime now, DropReason reason) {
    if (observer_ != nullptr) observer_->on_drop(packet, now, reason);
}

void LinkModel::change(SessionTime /*now*/, const LinkSettings& settings) {
    assert(settings.in_order == settings_.in_order && settings.capacity == settings_.capacity);
    settings_ = settings;
}

std::int64_t LinkModel::draw_delay_ns(std::uint64_t packet) {
    const std::int64_t mean_ns = settings_.delay.count();
    if (settings_.jitter.shape == JitterShape::kNone) return mean_ns;
    delay_stream_.seek(kNumbersPerDelay * packet);
    const double deviate = settings_.jitter.shape == JitterShape::kUniform ? delay_stream_.uniform(-1.0, 1.0)
                                                                           : delay_stream_.normal();
    const double spread_ns = static_cast<double>(settings_.jitter.spread.count());
    return std::max<std::int64_t>(0, mean_ns + std::llround(deviate * spread_ns));
}

std::uint32_t LinkModel::take_free_slot() {
    ++in_flight_;
    if (free_ == kNoSlot) return unused_++;
    const std::uint32_t slot = free_;
    free_ = slots_[slot].next;
    return slot;
}

// In order: a chain from the oldest to the newest.
void LinkModel::append(std::uint32_t slot) {
    last_due_ns_ = std::max(last_due_ns_, slots_[slot].due_ns);
    slots_[slot].due_ns = last_due_ns_;
    if (in_flight_ == 1) {
        head_ = slot;
        next_due_ = from_nanoseconds(last_due_ns_);
    } else {
        slots_[tail_].next = slot;
    }
    tail_ = slot;
}

// With reordering: a heap by due time, then packet number.
void LinkModel::insert(std::uint32_t slot, std::uint64_t packet) {
    heap_.push_back({slots_[slot].due_ns, packet, slot});
    std::push_heap(heap_.begin(), heap_.end(), leaves_later);
    next_due_ = from_nanoseconds(heap_.front().due_ns);
}

std::uint32_t LinkModel::remove_first() {
    --in_flight_;
    std::uint32_t first = head_;
    std::uint32_t second = kNoSlot;
    if (settings_.in_order) {
        if (in_flight_ > 0) second = head_ = slots_[first].next;
    } else {
        first = heap_.front().slot;
        std::pop_heap(heap_.begin(), heap_.end(), leaves_later);
        heap_.pop_back();
        if (in_flight_ > 0) second = heap_.front().slot;
    }
    next_due_ = second == kNoSlot ? kNever : from_nanoseconds(slots_[second].due_ns);
    return first;
}

Departure LinkModel::take_first(SessionTime now) {
    assert(in_flight_ > 0 && "pop_due at kNever");
    const std::uint32_t index = remove_first();
    Slot& slot = slots_[index];
    slot.next = free_;
    free_ = index;
    const Duration waited{to_nanoseconds(now) - slot.pushed_ns};
    delays_.sum += waited;
    delays_.min = std::min(delays_.min, waited);
    delays_.max = std::max(delays_.max, waited);
    ++delays_.count;
    ++counters_.delivered;
    return {.packet = slot.packet,
            .received = from_nanoseconds(slot.pushed_ns),
            .due = from_nanoseconds(slot.due_ns),
            .bytes = {slot.bytes.data(), slot.size}};
}

}  // namespace thimble
