#include "netem/stages/transmitter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "netem/packet_trace.hpp"

namespace thimble {

void Transmitter::configure(const LinkSettings& settings, Duration now) {
    rate_ = settings.rate;
    const bool has_rate = settings.trace != nullptr && settings.trace->layout().has_rate;
    trace_ = has_rate ? settings.trace.get() : nullptr;
    slots_.configure(settings.slot, now);
    deliveries_.configure(settings.deliveries, sending_ != nullptr ? done_ : now);
    active_ = rate_.bits_per_s > 0 || trace_ != nullptr || slots_.active() || deliveries_.active();
    earliest_ = now;
    if (sending_ == nullptr && !waiting_.empty()) plan_next();
}

bool Transmitter::sends_at_once() const { return empty() && !slots_.active() && !deliveries_.active(); }

bool Transmitter::could_hold(std::size_t bytes) const {
    return sends_at_once() || rate_.queue_bytes == 0 || bytes <= rate_.queue_bytes;
}

bool Transmitter::has_room(std::size_t bytes) const {
    if (sends_at_once()) return true;
    if (rate_.queue_packets > 0 && waiting_packets_ >= rate_.queue_packets) return false;
    return rate_.queue_bytes == 0 || waiting_bytes_ + bytes <= rate_.queue_bytes;
}

void Transmitter::add(Packet* packet) {
    const bool first = waiting_.empty();
    waiting_.append(packet);
    ++waiting_packets_;
    waiting_bytes_ += packet->size;
    if (sending_ == nullptr && first) plan_next();
}

Packet* Transmitter::take_waiting() {
    Packet* packet = waiting_.take_front();
    --waiting_packets_;
    waiting_bytes_ -= packet->size;
    return packet;
}

Packet* Transmitter::drop_oldest() {
    if (waiting_.empty()) return nullptr;
    Packet* oldest = take_waiting();
    if (sending_ == nullptr && !waiting_.empty()) plan_next();
    return oldest;
}

Packet* Transmitter::take_any() {
    if (!waiting_.empty()) return take_waiting();
    return std::exchange(sending_, nullptr);
}

void Transmitter::plan_next() {
    const Packet& next = *waiting_.front();
    const Duration from = std::max(arrival(next), earliest_);
    if (deliveries_.active()) {
        start_ = deliveries_.opening(from);
    } else if (slots_.active()) {
        start_ = slots_.opening(from, free_at_, bytes_on_air(next));
    } else {
        start_ = std::max(from, free_at_);
        begin();  // free, and nothing to wait for: not after the time that was asked for
    }
}

void Transmitter::begin() {
    sending_ = take_waiting();
    if (deliveries_.active()) {
        done_ = deliveries_.take(bytes_on_air(*sending_));
        return;
    }
    if (slots_.active()) slots_.take(bytes_on_air(*sending_));
    done_ = start_ + time_on_air(*sending_);
}

Duration Transmitter::time_on_air(const Packet& packet) {
    double bits_per_s = rate_.bits_per_s;
    if (trace_ != nullptr) bits_per_s = trace_->of(packet.number, start_).bits_per_s;
    if (bits_per_s <= 0) return {};
    if (start_ != free_at_) behind_ns_ = 0;
    const double exact_ns = 8e9 * static_cast<double>(bytes_on_air(packet)) / bits_per_s + behind_ns_;
    const Duration whole{std::llround(exact_ns)};
    behind_ns_ = exact_ns - static_cast<double>(whole.count());
    return whole;
}

std::optional<Transmitter::Sent> Transmitter::take_sent(Duration now) {
    if (sending_ == nullptr) {
        if (waiting_.empty() || start_ > now) return std::nullopt;
        begin();
    }
    if (done_ > now) return std::nullopt;
    free_at_ = done_;
    const Sent sent{std::exchange(sending_, nullptr), done_};
    if (!waiting_.empty()) plan_next();
    return sent;
}

Duration Transmitter::next_event() const {
    if (sending_ != nullptr) return done_;
    return waiting_.empty() ? kNothing : start_;
}

}  // namespace thimble
