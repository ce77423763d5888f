#include "tests/views/fake_session.hpp"

#include <algorithm>
#include <cmath>

#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr double kRest_m = 0.02, kOscillation_Hz = 15;
constexpr double kStiffness_N_per_m = 700;
constexpr double kInsertion_m_per_s = kDemonstrationFixture_m / kDemonstrationContact_s;

void move(Monitor& monitor, double time_s) {
    const double held_s = std::max(0.0, time_s - kDemonstrationContact_s);
    const double swing_m =
        kDemonstrationAmplitude_m * std::min(1.0, held_s) * std::sin(2 * M_PI * kOscillation_Hz * held_s);
    monitor.position_needle_m = std::min(time_s * kInsertion_m_per_s, kDemonstrationFixture_m) + swing_m;
    const double dimple_m = monitor.position_needle_m - kRest_m;
    const bool inside = time_s > 1.2;
    monitor.position_surface_m =
        inside ? kRest_m + 0.01 * std::exp(-(time_s - 1.2) * 2) : kRest_m + std::max(0.0, dimple_m);
    monitor.phase =
        inside ? TissuePhase::kPenetrated : (dimple_m > 0 ? TissuePhase::kContact : TissuePhase::kFree);
}

constexpr Duration kMonitorPeriod = std::chrono::milliseconds{4};

NetworkSettings view_network(std::uint16_t base_port) {
    NetworkSettings network;
    network.base_port = base_port;
    return network;
}

}  // namespace

Monitor demonstration(double time_s) {
    time_s = std::max(0.0, time_s);  // who starts anew may ask before
    Monitor monitor;
    monitor.state = NodeState::kRunning;
    monitor.modality = Modality::kHF;
    monitor.time_s = time_s;
    monitor.subject = 3;
    monitor.trials = 24;
    monitor.position_fixture_m = kDemonstrationFixture_m;
    monitor.fixture_present = true;
    move(monitor, time_s);
    const double beyond_m = std::max(0.0, monitor.position_needle_m - kDemonstrationFixture_m);
    const double held_s = std::max(0.0, time_s - kDemonstrationContact_s);
    monitor.force_tissue_N = monitor.phase == TissuePhase::kFree ? 0 : -0.4;
    monitor.force_fixture_N = -kStiffness_N_per_m * beyond_m;
    monitor.force_total_N = monitor.force_tissue_N + monitor.force_fixture_N;
    monitor.force_hand_N = -monitor.force_total_N;
    monitor.contact_time_s = held_s;
    monitor.energy_in_J = 0.004 * std::min(time_s, kDemonstrationContact_s) - 0.006 * held_s;
    monitor.round_trip_s = 0.0512 + 0.0004 * std::sin(9 * time_s);
    monitor.one_way_s = 0.0503;
    monitor.one_way_bound_s = 0.004;
    monitor.network_delay_s = 0.05;
    monitor.accepted = static_cast<std::uint64_t>(time_s * 5000);
    return monitor;
}

FakeSession::FakeSession(std::uint16_t base_port, std::uint64_t instance, double ahead_s)
    : sockets_(view_network(base_port)),
      views_{sockets_.between(Port::kSessionOrders, Port::kExperimenterMonitor),
             sockets_.between(Port::kSessionPlayerOrders, Port::kPlayerMonitor)},
      monitors_(Role::kSession, instance, {views_[0], views_[1]}),
      started_(wall_now() - from_seconds(ahead_s)),
      thread_([this](const std::stop_token& stop) {
          for (; !stop.stop_requested(); wall_sleep(std::chrono::milliseconds{2})) tick(wall_now());
      }) {}

int FakeSession::count(OrderKind kind) {
    const std::scoped_lock lock(mutex_);
    return static_cast<int>(std::count_if(heard_.begin(), heard_.end(),
                                          [kind](const Order& order) { return order.kind == kind; }));
}

std::optional<Order> FakeSession::last(OrderKind kind) {
    const std::scoped_lock lock(mutex_);
    const auto found = std::find_if(heard_.rbegin(), heard_.rend(),
                                    [kind](const Order& order) { return order.kind == kind; });
    return found == heard_.rend() ? std::nullopt : std::optional(*found);
}

void FakeSession::obey(bool obeys) {
    const std::scoped_lock lock(mutex_);
    obeys_ = obeys;
}

void FakeSession::fail(std::string_view words) {
    const std::scoped_lock lock(mutex_);
    fault_ = DeviceFault(words);
}

void FakeSession::take(const Order& order, SessionTime now) {
    heard_.push_back(order);
    if (!obeys_) return;
    if (order.kind == OrderKind::kDelay) delay_s_ = order.value;
    if (order.kind == OrderKind::kNetwork) {
        network_ = order.network;
        delay_s_ = order.value;
    }
    if (order.kind == OrderKind::kPause) paused_ = true;
    if (order.kind == OrderKind::kResume) paused_ = false;
    if (order.kind == OrderKind::kEndTrial) running_ = false;
    if (order.kind == OrderKind::kStart && order.trial == trial_) {
        ++trial_;
        started_ = now;
        running_ = true;
        modality_ = order.modality;
    }
}

void FakeSession::speak(SessionTime now) {
    Monitor monitor = demonstration(to_seconds(now - started_));
    monitor.network_delay_s = delay_s_;
    monitor.network = network_;
    monitor.paused = paused_;
    monitor.modality = modality_;
    if (!running_ || fault_) monitor.state = NodeState::kIdle;
    if (fault_) {
        monitor.reason = EndReason::kDeviceFault;
        monitors_.send(now, trial_, *fault_);
    }
    monitors_.send(now, trial_, monitor);
}

void FakeSession::tick(SessionTime now) {
    const std::scoped_lock lock(mutex_);
    sockets_.tick(now);
    for (std::size_t i = 0; i < views_.size(); ++i) {
        while (const Message* message = inbound_[i].receive(now, *views_[i])) {
            if (const auto* order = std::get_if<Order>(&message->body)) take(*order, now);
        }
    }
    if (next_ == SessionTime{}) next_ = now;
    // After a stall the samples of the stall come all at once, as recorded.
    for (; next_ <= now; next_ += kMonitorPeriod) speak(next_);
}

}  // namespace thimble
