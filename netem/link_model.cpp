#include "netem/link_model.hpp"

#include <algorithm>
#include <cassert>

#include "netem/stages/slots.hpp"

namespace thimble {
namespace {

bool is_plain(const LinkSettings& s) {
    return s.jitter.shape == JitterShape::kNone && s.loss.shape == LossShape::kNone && s.duplicate == 0 &&
           s.corrupt == 0 && s.reorder == 0 && s.rate.bits_per_s == 0 && s.slot.most == Duration::zero() &&
           s.outages.empty() && s.trace == nullptr && s.deliveries == nullptr;
}

bool understands_ecn(std::uint8_t traffic_class) { return (traffic_class & kCongestionExperienced) != 0; }

}  // namespace

LinkModel::Plan::Plan(Duration from, const LinkSettings& what)
    : at(from),
      settings(what),
      shape(std::make_shared<const DelayShape>(what.jitter, what.delay)),
      plain(is_plain(what)) {
    assert(what.capacity > 0 && what.delay >= Duration::zero() && what.jitter.spread >= Duration::zero());
    assert(stationary_loss(what.loss) <= 1);
}

LinkModel::LinkModel(const LinkSettings& settings, const StreamKey& key, std::uint32_t direction,
                     const Timeline& timeline, SessionTime start, SessionTime opened)
    : opened_(opened), direction_(direction), fates_(key, direction), transmitter_(key, direction, start) {
    assert(std::is_sorted(timeline.begin(), timeline.end(),
                          [](const LinkChange& a, const LinkChange& b) { return a.at < b.at; }));
    plans_.reserve(timeline.size() + 1);
    plans_.emplace_back(Duration::zero(), settings);
    for (const LinkChange& change : timeline) plans_.emplace_back(change.at, change.settings);
    restart(key, start);
}

void LinkModel::restart(const StreamKey& key, SessionTime start) {
    forget_all();
    start_ = start;
    fates_ = LinkFates(key, direction_);
    transmitter_ = Transmitter(key, direction_, start);
    next_plan_ = 1;
    next_due_ = kNever;
    latest_ = 0;
    counters_ = {};
    delays_ = {};
    use(0, Duration::zero());
    follow_timeline();
}

void LinkModel::forget_all() {
    while (forget_any() != nullptr) {
    }
    line_.reset();
    in_flight_ = 0;
}

void LinkModel::use(std::size_t plan, Duration time) {
    current_ = plan;
    const LinkSettings& now_valid = plans_[plan].settings;
    in_order_ = now_valid.in_order;
    delay_ns_ = now_valid.delay.count();
    capacity_ = now_valid.capacity;
    plain_ = plans_[plan].plain && transmitter_.empty();
    fates_.configure(plans_[plan].settings, plans_[plan].shape);
    transmitter_.configure(plans_[plan].settings, std::max(time, opened_ - start_));
}

void LinkModel::follow_timeline() {
    next_change_ = next_plan_ < plans_.size() ? start_ + plans_[next_plan_].at : kNever;
}

void LinkModel::change(SessionTime now, const LinkSettings& settings) {
    run_until(now);
    plans_[0] = Plan(Duration::zero(), settings);
    use(0, now - start_);
    update_next_due();
}

// Carries out what the timeline and the transmitter have until `now`, in the order of time.
void LinkModel::run_until(SessionTime now) {
    while (now >= next_change_) {
        send_until(plans_[next_plan_].at);
        use(next_plan_, plans_[next_plan_].at);
        ++next_plan_;
        follow_timeline();
    }
    send_until(now - start_);
    plain_ = plans_[current_].plain && transmitter_.empty();
    update_next_due();
}

void LinkModel::send_until(Duration time) {
    while (const auto sent = transmitter_.take_sent(time)) {
        sent->packet->due_ns += to_nanoseconds(start_ + sent->time);
        line_.add(sent->packet, in_order_);
    }
}

void LinkModel::wait_for_transmitter() {
    SessionTime event = start_ + transmitter_.next_event();
    // On a link in order nothing overtakes the next packet, whose delay still lies ahead.
    if (in_order_) event += Duration{transmitter_.next_packet()->due_ns};
    next_due_ = std::min(std::min(next_due_, event), next_change_);
}

void LinkModel::push(SessionTime now, Bytes datagram, std::uint8_t traffic_class) {
    const Arrival arrival{counters_.pushed++, now, datagram, traffic_class};
    if (now >= next_change_) run_until(now);
    if (!plain_) return push_by_fate(arrival);
    if (datagram.empty() || datagram.size() > kLargestDatagramBytes) {
        return drop(arrival, DropReason::kOversized);
    }
    if (in_flight_ >= capacity_) return drop(arrival, DropReason::kOverflowed);
    Packet* block = store(arrival);
    block->copy = block->corrupted = false;
    block->due_ns = block->received_ns + delay_ns_;
    line_.add(block, in_order_);
    next_due_ = line_.next_due();
}

Packet* LinkModel::store(const Arrival& arrival) {
    ++in_flight_;
    Packet* block = store_.take(arrival.datagram);
    block->number = arrival.packet;
    block->received_ns = to_nanoseconds(arrival.now);
    block->traffic_class = arrival.traffic_class;
    return block;
}

void LinkModel::push_by_fate(const Arrival& arrival) {
    const auto& [packet, now, datagram, traffic_class] = arrival;
    const bool may_mark = settings().ecn && understands_ecn(traffic_class);
    const PacketFate fate = fates_.decide(packet, now - start_, may_mark);
    if (fate.lost) return drop(arrival, DropReason::kLost);
    if (is_out(settings().outages, now - start_)) return drop(arrival, DropReason::kOutage);
    if (datagram.empty() || datagram.size() > kLargestDatagramBytes) {
        return drop(arrival, DropReason::kOversized);
    }
    counters_.skipped += fate.skipped ? 1 : 0;
    counters_.corrupted += fate.corrupted ? 1 : 0;
    counters_.marked += fate.marked ? 1 : 0;
    admit(arrival, fate, false);
    if (!fate.duplicated) return;
    ++counters_.duplicated;
    admit(arrival, fate, true);
}

void LinkModel::admit(const Arrival& arrival, const PacketFate& fate, bool copy) {
    const auto& [packet, now, datagram, traffic_class] = arrival;
    if (transmitter_.active()) run_until(now);
    // After the capacity has shrunk: no waiting packet makes room for a new one that does not fit.
    if (in_flight_ > capacity_) return drop(arrival, DropReason::kOverflowed);
    const bool waits = transmitter_.active();  // a removed rate ends with the last packet that it held up
    if (waits && !make_room(datagram.size())) return drop(arrival, DropReason::kQueueFull);
    if (in_flight_ >= capacity_) return drop(arrival, DropReason::kOverflowed);
    Packet* block = store(arrival);
    block->copy = copy;
    block->corrupted = fate.corrupted;
    if (fate.marked) block->traffic_class |= kCongestionExperienced;
    block->due_ns = (copy ? fate.copy_delay : fate.delay).count();
    if (fate.corrupted) fates_.flip_bits(packet, {block->data(), block->size});
    if (waits) {
        transmitter_.add(block);
    } else {
        block->due_ns += block->received_ns;
        line_.add(block, in_order_);
    }
    update_next_due();
}

// False: there is no room for a packet of `bytes`.
bool LinkModel::make_room(std::size_t bytes) {
    if (!transmitter_.could_hold(bytes)) return false;  // then no packet has to make room
    while (!transmitter_.has_room(bytes)) {
        Packet* oldest = settings().rate.drop == Drop::kHead ? transmitter_.drop_oldest() : nullptr;
        if (oldest == nullptr) return false;
        --in_flight_;
        drop({oldest->number, from_nanoseconds(oldest->received_ns), oldest->bytes(), oldest->traffic_class},
             DropReason::kQueueFull);
        store_.give_back(oldest);
    }
    return true;
}

void LinkModel::drop(const Arrival& arrival, DropReason reason) {
    constexpr std::array<std::uint64_t LinkCounters::*, 5> kByReason{
        &LinkCounters::lost, &LinkCounters::outage, &LinkCounters::oversized, &LinkCounters::queue_full,
        &LinkCounters::overflowed};
    ++(counters_.*kByReason[static_cast<std::size_t>(reason)]);
    if (observer_ != nullptr)
        observer_->on_drop(arrival.packet, arrival.now, arrival.datagram.size(), reason);
}

Packet* LinkModel::take_first(SessionTime now) {
    assert(in_flight_ > 0 && "pop_due at kNever");
    if (!plain_ && !transmitter_.empty()) {
        run_until(now);
        if (now < line_.next_due()) return nullptr;
    }
    Packet* packet = line_.take_first();
    store_.give_back(packet);
    --in_flight_;
    if (plain_) {
        next_due_ = line_.next_due();
    } else {
        update_next_due();
    }
    count_delivered(packet->number, Duration{to_nanoseconds(now) - packet->received_ns}, packet->copy);
    return packet;
}

Departure LinkModel::pop_departure(SessionTime now) {
    Packet* packet = now < next_due_ ? nullptr : take_first(now);
    if (packet == nullptr) return {};
    return {.packet = packet->number,
            .received = from_nanoseconds(packet->received_ns),
            .due = from_nanoseconds(packet->due_ns),
            .bytes = packet->bytes(),
            .copy = packet->copy,
            .corrupted = packet->corrupted,
            .traffic_class = packet->traffic_class};
}

LinkCounters& LinkCounters::operator+=(const LinkCounters& other) {
    for (const LinkCounter& counter : kReportedCounters) this->*counter.value += other.*counter.value;
    skipped += other.skipped;
    marked += other.marked;
    return *this;
}

}  // namespace thimble
