#include "cutaneous_node/can/canopen_master.hpp"

#include <algorithm>
#include <cassert>

namespace thimble {
namespace {

constexpr std::uint8_t kNoLink = 0xff;
constexpr int kFullCycles = 5;

}  // namespace

CanopenMaster::CanopenMaster(const CanMasterSettings& settings, CanBus& bus)
    : settings_(settings), bus_(&bus) {
    assert(settings.cycle > Duration::zero());
    link_of_.fill(kNoLink);
    links_.reserve(settings_.nodes.size());
    for (std::size_t i = 0; i < settings_.nodes.size(); ++i) {
        assert(settings_.nodes[i] > 0 && settings_.nodes[i] < 127 && link_of_[settings_.nodes[i]] == kNoLink);
        links_.emplace_back(settings_, i);
        link_of_[settings_.nodes[i]] = static_cast<std::uint8_t>(i);
    }
}

bool CanopenMaster::operating() const {
    return !fault_ &&
           std::all_of(links_.begin(), links_.end(), [](const DriveLink& link) { return link.operating(); });
}

bool CanopenMaster::unanswered() const {
    return std::any_of(links_.begin(), links_.end(), [](const DriveLink& link) { return link.unanswered(); });
}

void CanopenMaster::tick(SessionTime now) {
    if (!begun_) {
        begun_ = true;
        for (DriveLink& link : links_) link.begin(now, *bus_);
        next_ = next_heartbeat_ = now;
    }
    take_frames(now);
    if (!fault_) {
        for (DriveLink& link : links_) {
            link.tick(now, *bus_);
            if (link.fault()) return fail(now, *link.fault());
        }
        if (bus_->down()) return fail(now, {DriveFaultKind::kBusDown, 0, "", 0});
    }
    look_at_answers(now);
    if (now >= next_) cycle(now);
    bus_->flush();
}

void CanopenMaster::take_frames(SessionTime now) {
    CanFrame frame;
    while (bus_->receive(now, frame)) take(now, frame);
}

void CanopenMaster::take(SessionTime now, const CanFrame& frame) {
    if ((frame.id & kCanError) != 0) {
        const BusTrouble trouble = trouble_of(frame);
        if (trouble == BusTrouble::kPassive) ++passive_;
        if (trouble == BusTrouble::kOff) fail(now, {DriveFaultKind::kBusOff, 0, "", 0});
        return;
    }
    if ((frame.id & (kCanExtended | kCanRemote)) != 0) return;
    const std::uint8_t link = link_of_[cob_node(frame.id)];
    if (link != kNoLink) links_[link].on_frame(now, frame, *bus_);
}

void CanopenMaster::look_at_answers(SessionTime now) {
    if (!waiting_) return;
    if (std::any_of(links_.begin(), links_.end(), [](const DriveLink& link) { return link.awaits_answer(); }))
        return;
    waiting_ = false;
    answered_within_.add(now - sync_);
}

void CanopenMaster::cycle(SessionTime now) {
    // Keeps to the grid; a late call skips what was missed.
    next_ += settings_.cycle * ((now - next_) / settings_.cycle + 1);
    if (now >= next_heartbeat_) {
        bus_->send(heartbeat_frame(settings_.master_node, NetworkState::kOperational));
        next_heartbeat_ = now + settings_.silent_after / 4;
    }
    const bool any =
        std::any_of(links_.begin(), links_.end(), [](const DriveLink& link) { return link.exchanges(); });
    if (!any) return;
    if (waiting_) ++incomplete_;
    exchange(fault_.has_value());
    for (DriveLink& link : links_) {
        if (link.exchanges()) link.on_sync(now);
    }
    sync_ = now;
    waiting_ = true;
    ++cycles_;
    watch_queue(now);
}

// A full queue drops the SYNC first, the last frame of a cycle: drives stay alive but do not move.
void CanopenMaster::watch_queue(SessionTime now) {
    const std::uint64_t failed = bus_->counters().send_failed;
    full_ = failed > send_failed_ ? full_ + 1 : 0;
    send_failed_ = failed;
    if (full_ == kFullCycles) fail(now, {DriveFaultKind::kQueueFull, 0, "", 0});
}

void CanopenMaster::exchange(bool slack) {
    for (DriveLink& link : links_) {
        if (slack || link.exchanges()) link.send_target(*bus_, slack);
    }
    bus_->send(sync_frame());
}

void CanopenMaster::fail(SessionTime now, const DriveFault& fault) {
    if (fault_) return;
    fault_ = fault;
    exchange(true);
    bus_->flush();
    for (DriveLink& link : links_) link.on_sync(now);
    next_ = std::max(next_, now);
}

void CanopenMaster::stop() {
    for (int twice = 0; twice < 2; ++twice) exchange(true);
    bus_->send(network_frame(NetworkCommand::kPreOperational, 0));
    bus_->flush();
}

}  // namespace thimble
