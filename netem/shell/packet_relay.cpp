#include "netem/shell/packet_relay.hpp"

#include <algorithm>
#include <cerrno>
#include <unistd.h>
#include <utility>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/relay_engine.hpp"
#include "netem/shell/ip_packet.hpp"

namespace thimble {
namespace {

constexpr std::size_t kPacketsPerTurn = 16;
constexpr std::size_t kReadsPerTurn = 32;
constexpr std::uint64_t kWakeTag = 1000;
constexpr std::size_t kRoomBytes = 65536 + kEthernetBytes;

LinkModel link_of(const PacketRelaySettings& settings, bool up, SessionTime start) {
    return {up ? settings.links.up : settings.links.down,
            flow_key(settings.seed, 0, 0),
            up ? kRelayUp : kRelayDown,
            up ? settings.timelines.up : settings.timelines.down,
            start,
            start};
}

bool same(Bytes a, const std::vector<std::uint8_t>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

}  // namespace

PacketRelay::PacketRelay(const PacketRelaySettings& settings, PacketSink* log, int wake)
    : settings_(settings),
      log_(log),
      waiter_(settings.precise),
      start_(wall_now()),
      links_{link_of(settings, true, start_), link_of(settings, false, start_)},
      ports_{settings.inner} {
    ports_.insert(ports_.end(), settings.outer.begin(), settings.outer.end());
    stamps_.reserve(ports_.size());
    for (const PacketPort& port : ports_) stamps_.push_back(std::make_unique<DeviceStamps>(port.stamps));
    bool added = wake < 0 || waiter_.add(wake, kWakeTag);
    for (std::size_t i = 0; i < ports_.size(); ++i) added = waiter_.add(ports_[i].descriptor, i) && added;
    if (!added) throw Error(ExitCode::kRunFailed, "cannot wait for packets: too many open files?");
    for (std::size_t d = 0; log_ != nullptr && d < 2; ++d) {
        const PacketRecord fixed{.direction = static_cast<RelayDirection>(d)};
        links_[d].observe(&drops_[d].emplace(*log_, fixed));
    }
}

PacketRelay::~PacketRelay() = default;

bool PacketRelay::step(SessionTime latest) {
    std::array<epoll_event, 8> room{};
    const SessionTime begin = next_due() - send_lead();
    const bool waited = begin > wall_now();
    const auto events = waiter_.wait(begin, latest, room);
    const SessionTime now = wall_now();
    if (next_due() <= now + send_lead()) {
        if (waited) sending_.waking.add(now - begin);
        woken_ = now;
        send_due(now + send_lead());
    }
    for (const epoll_event& event : events) {
        if (event.data.u64 != kWakeTag) receive(event.data.u64);
    }
    if (!events.empty()) send_due(wall_now());
    return !events.empty();
}

// The two links take turns: a flood in one direction cannot hold up the other.
void PacketRelay::send_due(SessionTime now) {
    if (next_due() > now) return;
    if (now - next_due() > kStall) ++totals_.stalls;
    for (bool more = true; more;) {
        const bool up = send_turn(0, now);
        more = send_turn(1, now) || up;
    }
}

bool PacketRelay::send_turn(std::size_t direction, SessionTime now) {
    for (std::size_t i = 0; i < kPacketsPerTurn; ++i) {
        const Departure departure = links_[direction].pop_departure(now);
        if (departure.bytes.empty()) return false;
        send(direction, departure);
    }
    return true;
}

const PacketPort& PacketRelay::port_for(std::size_t direction, Bytes packet) const {
    if (direction == 1) return ports_.front();
    const Bytes destination = read_ip_packet(packet).destination;
    const auto found = std::find_if(ports_.begin() + 1, ports_.end(), [&](const PacketPort& port) {
        return !destination.empty() && (same(destination, port.host4) || same(destination, port.host6));
    });
    return found == ports_.end() ? ports_.back() : *found;
}

// As it leaves: the link marks beside the packet, whose header has the bits. A corrupted header may be none any more.
Bytes PacketRelay::packet_of(const Departure& departure) {
    const bool congested = (departure.traffic_class & kCongestionExperienced) == kCongestionExperienced;
    if (!congested || read_ip_packet(departure.bytes).kind == IpKind::kGarbage) return departure.bytes;
    marked_.assign(departure.bytes.begin(), departure.bytes.end());
    mark_congestion(marked_);
    return marked_;
}

void PacketRelay::send(std::size_t direction, const Departure& departure) {
    const Bytes packet = packet_of(departure);
    const PacketPort& port = port_for(direction, packet);
    const SessionTime before = wall_now();
    if (const SessionTime woken = std::exchange(woken_, kNever); woken != kNever) {
        handling_.add(before - woken);
        sending_.handling.add(before - woken);
    }
    const bool accepted = port.ethernet ? send_frame(port.descriptor, packet)
                                        : write(port.descriptor, packet.data(), packet.size()) > 0;
    const SessionTime sent = wall_now();
    writing_.add(sent - before);
    sending_.writing.add(sent - before);
    record_sent(direction, departure, sent, accepted);
}

void PacketRelay::record_sent(std::size_t direction, const Departure& departure, SessionTime sent,
                              bool accepted) {
    totals_.direction[direction].note(departure, sent, accepted);
    if (accepted) note_stages(direction, departure);
    if (log_ == nullptr) return;
    PacketRecord record = record_of(departure, sent, accepted);
    record.direction = static_cast<RelayDirection>(direction);
    log_->add(record);
}

void PacketRelay::note_stages(std::size_t direction, const Departure& departure) {
    const LinkSettings& link = links_[direction].settings();
    const double bits = 8.0 * static_cast<double>(link.rate.bytes_on_air(departure.bytes.size()));
    const Duration rate = link.rate.bits_per_s > 0 ? from_seconds(bits / link.rate.bits_per_s) : Duration{};
    StageTotals& stages = stages_[direction];
    stages.rate_sum += rate;
    stages.queue.add(std::max(Duration{}, departure.due - departure.received - rate - mean_delay(link)));
}

void PacketRelay::receive(std::size_t port) {
    DeviceStamps& stamps = *stamps_[port];
    stamps.update();
    for (std::size_t i = 0; i < kReadsPerTurn && read_one(port, stamps); ++i) {
    }
}

// False: there is none, or the port has no other end any more.
bool PacketRelay::read_one(std::size_t port, DeviceStamps& stamps) {
    // read() fills it. NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
    std::array<std::uint8_t, kRoomBytes> room;
    const auto size = read(ports_[port].descriptor, room.data(), room.size());
    const SessionTime now = wall_now();  // after the call: no stamp is later
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return false;
    if (size <= 0) {
        close_port(port);
        return false;
    }
    const Bytes frame{room.data(), static_cast<std::size_t>(size)};
    const SessionTime received = stamps.of(frame, now);
    const IpPacket packet = read_ip_packet(ports_[port].ethernet ? ip_of_frame(frame) : frame);
    if (packet.tcp) tcp_read_ = now;
    if (packet.kind == IpKind::kData) {
        push(port == 0 ? 0 : 1, packet, received);
    } else {
        ++(packet.kind == IpKind::kLocal ? port_totals_.local : port_totals_.garbage);
    }
    return true;
}

// A link's packets never go back in time.
void PacketRelay::push(std::size_t direction, const IpPacket& packet, SessionTime received) {
    last_received_[direction] = std::max(last_received_[direction], received);
    links_[direction].push(last_received_[direction], packet.bytes, packet.traffic_class);
}

// The other ports go on: a shell whose slirp4netns has ended still reaches this machine.
void PacketRelay::close_port(std::size_t port) {
    waiter_.remove(ports_[port].descriptor);
    ++port_totals_.ports_closed;
}

void PacketRelay::change(SessionTime now, const LinkPair& links) {
    settings_.links = links;
    forget_passed(settings_.timelines, now - start_);
    links_[0].change(now, links.up);
    links_[1].change(now, links.down);
}

RelayState PacketRelay::state(SessionTime now) const {
    RelayState state{.links = links_at(settings_.links, settings_.timelines, now - start_),
                     .totals = totals_,
                     .waiting = waiter_.counters(),
                     .margin = waiter_.margin(),
                     .precise = waiter_.precise(),
                     .send_lead = send_lead()};
    for (std::size_t d = 0; d < 2; ++d) {
        state.totals.direction[d].packets = links_[d].counters();
        state.totals.direction[d].in_flight = links_[d].in_flight();
    }
    state.totals.flows = state.totals.flows_opened = 1;
    state.totals.log_missing = log_ == nullptr ? 0 : log_->missing();
    for (const auto& stamps : stamps_) state.totals.untrusted_stamps += stamps->missing();
    state.totals.running = now - start_;
    return state;
}

}  // namespace thimble
