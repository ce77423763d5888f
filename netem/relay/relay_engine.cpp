#include "netem/relay/relay_engine.hpp"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

// How many packets of one link leave before the next link has its turn.
constexpr std::size_t kTurn = 16;
// How long a stop may wait for a sleeping relay.
constexpr Duration kHousekeeping = std::chrono::milliseconds{100};
// Below, datagrams leave one by one, so that captures and queue disciplines behind see them as they are. At most a third of
// what this program sends without joining.
constexpr double kJoinFrom_per_s = 50'000;
constexpr std::uint64_t kInletTags = std::uint64_t{1} << 32;  // below: the place of a flow

std::size_t index(RelayDirection direction) { return static_cast<std::size_t>(direction); }

}  // namespace

RelayEngine::RelayEngine(const RelaySettings& settings, PacketSink* log)
    : settings_(settings),
      log_(log),
      waiter_(settings.precise),
      send_cost_(measure_send_cost()),
      table_(settings.most_flows, settings.inlets.size()),
      flows_(settings.most_flows),
      due_(2 * settings.most_flows),
      last_housekeeping_(wall_now()),
      start_(wall_now()),
      next_housekeeping_(start_ + kHousekeeping),
      next_expiry_(start_ + settings.idle / 4) {
    inlet_turns_.resize(settings_.inlets.size());
    totals_.closed_ports.resize(settings_.inlets.size());
    active_.reserve(2 * settings.most_flows);
    outgoing_.reserve(SendBatch::kSize);
    for (const RelayInlet& inlet : settings_.inlets) {
        inlets_.push_back(UdpSocket::listening(inlet.listen));
        inlets_.back().tell_traffic_class();
        if (!waiter_.add(inlets_.back().descriptor(), kInletTags + inlets_.size() - 1)) {
            throw Error(ExitCode::kRunFailed, "cannot wait for datagrams: too many open files?");
        }
    }
}

RelayEngine::~RelayEngine() = default;

void RelayEngine::step(SessionTime latest) {
    std::array<epoll_event, 64> room{};
    const Duration lead = send_lead();
    const auto events = waiter_.wait(due_.first_due() - lead, std::min(latest, next_housekeeping_), room);
    SessionTime now = wall_now();
    if (due_.first_due() <= now + lead) {
        woken_ = now;
        send_due(now + lead);
        now = wall_now();
    }
    if (!events.empty()) {
        receive(events);
        send_due(wall_now() + send_cost_);
    }
    if (now >= next_housekeeping_) housekeep(now);
}

// Each link with due packets sends a few per turn, so that a busy flow does not delay the others.
void RelayEngine::send_due(SessionTime now) {
    if (due_.first_due() > now) return;
    if (now - due_.first_due() > kStall) ++totals_.stalls;
    active_.clear();
    for (; due_.first_due() <= now; due_.set(due_.first(), kNever)) active_.push_back(due_.first());
    while (!active_.empty()) {
        for (const std::uint32_t link : active_) serve(link, now);
        std::erase_if(active_, [&](std::uint32_t link) {
            if (model(link).next_due() <= now) return false;
            due_.set(link, model(link).next_due());
            return true;
        });
    }
    flush();
}

void RelayEngine::serve(std::uint32_t link, SessionTime now) {
    const std::uint32_t place = link / 2;
    const bool up = link % 2 == index(RelayDirection::kUp);
    const FlowName& name = table_.name(place);
    const int socket = up ? flows_[place]->server.descriptor() : inlets_[name.inlet].descriptor();
    for (std::size_t i = 0; i < kTurn; ++i) {
        const Departure departure = model(link).pop_departure(now);
        if (departure.bytes.empty()) return;
        if (batch_.full() || socket != batch_socket_) flush();
        batch_socket_ = socket;
        batch_.add(departure.bytes, up ? nullptr : &name.client, departure.traffic_class,
                   settings_.inlets[name.inlet].to.is_ipv4());
        outgoing_.push_back({link, departure});
    }
}

void RelayEngine::flush() {
    if (outgoing_.empty()) return;
    if (const SessionTime woken = std::exchange(woken_, kNever); woken != kNever)
        handling_.add(wall_now() - woken);
    const std::uint64_t closed = batch_.closed_ports();
    const auto accepted = batch_.send(batch_socket_);
    const SessionTime sent = wall_now();
    handed_over_ += outgoing_.size();
    if (batch_.closed_ports() != closed)
        totals_.closed_ports[table_.name(outgoing_.front().link / 2).inlet] += batch_.closed_ports() - closed;
    for (std::size_t i = 0; i < outgoing_.size(); ++i) record_sent(outgoing_[i], sent, accepted[i]);
    outgoing_.clear();
}

void RelayEngine::record_sent(const Outgoing& out, SessionTime sent, bool accepted) {
    totals_.direction[out.link % 2].note(out.departure, sent, accepted);
    if (log_ == nullptr) return;
    PacketRecord record = record_of(out.departure, sent, accepted);
    name_link(record, out.link);
    log_->add(record);
}

void RelayEngine::name_link(PacketRecord& record, std::uint32_t link) const {
    record.flow = table_.number(link / 2);
    record.inlet = static_cast<std::uint16_t>(table_.name(link / 2).inlet);
    record.direction = static_cast<RelayDirection>(link % 2);
}

void RelayEngine::receive(std::span<const epoll_event> events) {
    stamps_.update(read_clock_pair());
    for (const epoll_event& event : events) {
        const std::uint64_t tag = event.data.u64;
        if (tag >= kInletTags) {
            receive_from_clients(static_cast<std::uint32_t>(tag - kInletTags));
        } else {
            receive_from_server(static_cast<std::uint32_t>(tag));
        }
    }
}

std::size_t RelayEngine::receive_turn(int descriptor, ReceiveTurn& turn) {
    const std::size_t count = arrivals_.receive(descriptor, turn.most());
    turn.got(count);
    return count;
}

void RelayEngine::receive_from_clients(std::uint32_t inlet) {
    const std::size_t count = receive_turn(inlets_[inlet].descriptor(), inlet_turns_[inlet]);
    const SessionTime now = wall_now();  // after the call: no stamp is later, and none is cut down
    for (std::size_t i = 0; i < count; ++i) {
        const ReceiveBatch::Datagram datagram = arrivals_[i];
        const SessionTime received = stamps_.to_session(datagram.stamp_realtime_ns, now);
        if (const auto place = flow_of({inlet, datagram.from}, received, now)) {
            push(2 * *place + static_cast<std::uint32_t>(RelayDirection::kUp), datagram, received);
        }
    }
}

void RelayEngine::receive_from_server(std::uint32_t place) {
    if (!table_.open(place)) return;
    const std::uint64_t closed = arrivals_.closed_ports();
    const std::size_t count = receive_turn(flows_[place]->server.descriptor(), flows_[place]->turn);
    totals_.closed_ports[table_.name(place).inlet] += arrivals_.closed_ports() - closed;
    const SessionTime now = wall_now();
    if (count > 0) table_.alive(place, now);
    for (std::size_t i = 0; i < count; ++i) {
        push(2 * place + static_cast<std::uint32_t>(RelayDirection::kDown), arrivals_[i],
             stamps_.to_session(arrivals_[i].stamp_realtime_ns, now));
    }
}

// A link's packets never go back in time: where a stamp could not be trusted, the one before it may be later.
void RelayEngine::push(std::uint32_t link, const ReceiveBatch::Datagram& datagram, SessionTime received) {
    SessionTime& last = flows_[link / 2]->last_received[link % 2];
    last = std::max(last, received);
    model(link).push(last, datagram.bytes, datagram.traffic_class);
    due_.set(link, model(link).next_due());
}

std::optional<std::uint32_t> RelayEngine::flow_of(const FlowName& name, SessionTime received,
                                                  SessionTime now) {
    const auto found = table_.find(name, now);
    if (!found) {
        ++totals_.flows_refused;
        return std::nullopt;
    }
    if (found->fresh && !open_flow(found->place, received)) {
        ++totals_.flows_failed;
        table_.refuse(found->place);
        return std::nullopt;
    }
    return found->place;
}

bool RelayEngine::open_flow(std::uint32_t place, SessionTime received) {
    const FlowName& name = table_.name(place);
    const StreamKey key = flow_key(settings_.seed, name.inlet, table_.number(place));
    try {
        auto flow = std::make_unique<Flow>(Flow{
            UdpSocket::connected(settings_.inlets[name.inlet].to),
            {LinkModel(settings_.links.up, key, kRelayUp, settings_.timelines.up, start_, received),
             LinkModel(settings_.links.down, key, kRelayDown, settings_.timelines.down, start_, received)}});
        flow->server.tell_traffic_class();
        if (!waiter_.add(flow->server.descriptor(), place)) return false;
        if (log_ != nullptr) log_drops(*flow, place);
        flows_[place] = std::move(flow);
        return true;
    } catch (const Error& error) {  // no route, or no more sockets: the other flows go on
        if (totals_.flows_failed == 0) spdlog::warn(error.what());
        return false;
    }
}

void RelayEngine::log_drops(Flow& flow, std::uint32_t place) {
    for (std::uint32_t d = 0; d < 2; ++d) {
        PacketRecord fixed;
        name_link(fixed, 2 * place + d);
        flow.links[d].observe(&flow.drops[d].emplace(*log_, fixed));
    }
}

void RelayEngine::close_flow(std::uint32_t place) {
    Flow& flow = *flows_[place];
    waiter_.remove(flow.server.descriptor());
    totals_.dropped_by_kernel += flow.server.dropped_by_kernel();
    for (std::uint32_t d = 0; d < 2; ++d) {
        totals_.direction[d].packets += flow.links[d].counters();
        due_.set(2 * place + d, kNever);
    }
    flows_[place].reset();
    table_.close(place);
}

// A flow with packets in flight is not idle, however long its delays.
void RelayEngine::expire_flows(SessionTime now) {
    for (const std::uint32_t place : table_.idle_since(now - settings_.idle)) {
        const auto& links = flows_[place]->links;
        if (links[0].in_flight() + links[1].in_flight() == 0) close_flow(place);
    }
}

void RelayEngine::housekeep(SessionTime now) {
    next_housekeeping_ = now + kHousekeeping;
    const double passed_s = to_seconds(now - last_housekeeping_);
    batch_.join(static_cast<double>(std::exchange(handed_over_, 0)) > kJoinFrom_per_s * passed_s);
    last_housekeeping_ = now;
    if (now < next_expiry_) return;
    expire_flows(now);
    next_expiry_ = now + settings_.idle / 4;
}

void RelayEngine::change(SessionTime now, const LinkPair& links) {
    settings_.links = links;
    forget_passed(settings_.timelines, now - start_);
    for (std::uint32_t place = 0; place < flows_.size(); ++place) {
        if (!table_.open(place)) continue;
        flows_[place]->links[index(RelayDirection::kUp)].change(now, links.up);
        flows_[place]->links[index(RelayDirection::kDown)].change(now, links.down);
        for (const std::uint32_t link : {2 * place, 2 * place + 1}) due_.set(link, model(link).next_due());
    }
}

RelayState RelayEngine::state(SessionTime now) const {
    return {.links = links_at(settings_.links, settings_.timelines, now - start_),
            .totals = totals(now),
            .waiting = waiter_.counters(),
            .margin = waiter_.margin(),
            .precise = waiter_.precise(),
            .send_lead = send_lead()};
}

RelayTotals RelayEngine::totals(SessionTime now) const {
    RelayTotals totals = totals_;
    for (std::uint32_t place = 0; place < flows_.size(); ++place) {
        if (!table_.open(place)) continue;
        totals.dropped_by_kernel += flows_[place]->server.dropped_by_kernel();
        for (std::size_t d = 0; d < 2; ++d) {
            totals.direction[d].packets += flows_[place]->links[d].counters();
            totals.direction[d].in_flight += flows_[place]->links[d].in_flight();
        }
    }
    for (const UdpSocket& inlet : inlets_) totals.dropped_by_kernel += inlet.dropped_by_kernel();
    totals.flows = table_.size();
    totals.flows_opened = table_.opened();
    totals.clock_steps = stamps_.steps();
    totals.untrusted_stamps = stamps_.untrusted();
    totals.log_missing = log_ == nullptr ? 0 : log_->missing();
    totals.running = now - start_;
    return totals;
}

}  // namespace thimble
