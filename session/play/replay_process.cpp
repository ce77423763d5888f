#include "session/play/replay_process.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <variant>

#include "common/node_process.hpp"

namespace thimble {

ReplayClock::ReplayClock(double duration_s, double speed)
    : duration_s_(duration_s), speed_(std::clamp(speed, kSlowest, kFastest)) {
    assert(duration_s >= 0);
}

double ReplayClock::time_s(SessionTime now) const {
    const double run_s = running_ ? speed_ * to_seconds(now - since_) : 0;
    return std::clamp(anchor_s_ + run_s, 0.0, duration_s_);
}

void ReplayClock::resume(SessionTime now) {
    if (running_) return;
    since_ = now;
    running_ = true;
}

void ReplayClock::pause(SessionTime now) {
    anchor_s_ = time_s(now);
    running_ = false;
}

void ReplayClock::seek(SessionTime now, double time_s) {
    anchor_s_ = std::clamp(time_s, 0.0, duration_s_);
    since_ = now;
}

void ReplayClock::set_speed(SessionTime now, double speed) {
    anchor_s_ = time_s(now);
    since_ = now;
    speed_ = std::clamp(speed, kSlowest, kFastest);
}

namespace {

constexpr int kBeepsSaid = 5;
constexpr Duration kSteerPeriod = std::chrono::milliseconds{50};
constexpr Duration kStatePeriod = std::chrono::milliseconds{100};

}  // namespace

ReplayProcess::ReplayProcess(std::uint64_t instance, const RecordedTrial& trial, double speed,
                             const Channels& channels)
    : trial_(&trial),
      channels_(channels),
      clock_(trial.duration_s(), speed),
      control_(Role::kSession, instance, {channels.control}),
      force_(Role::kSlaveSim, instance, {channels.force}),
      scene_(Role::kSlaveSim, instance, {channels.scene}),
      monitor_(Role::kSession, instance,
               {channels.views.experimenter_monitor, channels.views.player_monitor}),
      experimenter_(*channels.views.experimenter_orders, *this),
      player_(*channels.views.player_orders, *this),
      state_(replay_state_of(trial)) {}

void ReplayProcess::tick(SessionTime now) {
    listen(now);
    experimenter_.tick(now, number_);
    player_.tick(now, number_);
    if (now >= next_steer_) steer(now);
    if (now < next_) return;
    next_ = now + kMonitorPeriod;
    if (shown_) show(now);
    monitor_.send(now, number_, monitor(now));
    if (now < next_state_) return;
    next_state_ = now + kStatePeriod;
    state_.speed = clock_.speed();
    monitor_.send(now, number_, state_);
}

void ReplayProcess::listen(SessionTime now) {
    while (const Message* message = answers_.receive(now, *channels_.control)) {
        const auto* heartbeat = std::get_if<Heartbeat>(&message->body);
        if (heartbeat == nullptr) continue;
        visual_ = *heartbeat;
        const bool running = message->header.trial == number_ && heartbeat->state == NodeState::kRunning;
        if (!running || shown_) continue;
        shown_ = true;
        rest(now);
        next_ = {};  // what is to be seen follows at once
        if (wants_to_run_) clock_.resume(now);
    }
}

// Repeats the order while the trial is shown: it is harmless and shows that this program is alive.
void ReplayProcess::steer(SessionTime now) {
    next_steer_ = now + kSteerPeriod;
    control_.send(now, number_, start_order(trial_->record.conditions));
}

// Also sent while the replay is paused: otherwise the screen would take slave_sim for lost.
void ReplayProcess::show(SessionTime now) {
    const double time_s = clock_.time_s(now);
    const double felt_s = time_s - trial_->delay_s(time_s);
    force_.send(now, number_, trial_->feedback(trial_->at(felt_s)));
    scene_.send(now, number_, trial_->feedback(trial_->at(time_s)));
    beep(now, time_s);
}

// A dimple is drawn against the surface of a trial's first sample, wherever the replay begins.
void ReplayProcess::rest(SessionTime now) {
    force_.send(now, number_, trial_->feedback(trial_->record.samples.front()));
    scene_.send(now, number_, trial_->feedback(trial_->record.samples.front()));
}

// Said several times, as slave_sim does: UDP may lose it, and the node beeps once per trial.
void ReplayProcess::beep(SessionTime now, double shown_s) {
    if (!(shown_s >= trial_->record.beep_time_s)) return;  // nor if there was none
    SessionControl control;
    control.kind = ControlKind::kBeep;
    if (beeps_ == kBeepsSaid) return;
    scene_.send(now, number_, control);
    ++beeps_;
}

std::optional<Refusal> ReplayProcess::obey(SessionTime now, const Order& order) {
    switch (order.kind) {
        case OrderKind::kSeek:
            clock_.seek(now, order.value);
            if (beeps_ > 0 && clock_.time_s(now) < trial_->record.beep_time_s) begin_anew();
            return std::nullopt;
        case OrderKind::kSpeed:
            if (order.value < ReplayClock::kSlowest || order.value > ReplayClock::kFastest)
                return Refusal::kOutOfRange;
            clock_.set_speed(now, order.value);
            next_state_ = {};
            return std::nullopt;
        case OrderKind::kPause:
            wants_to_run_ = false;
            clock_.pause(now);
            return std::nullopt;
        case OrderKind::kResume:
            wants_to_run_ = true;
            if (shown_) clock_.resume(now);
            return std::nullopt;
        case OrderKind::kQuit:
            quit_ = true;
            return std::nullopt;
        default:
            return Refusal::kUnexpectedKind;
    }
}

// Another number, so that the screen forgets the beep.
void ReplayProcess::begin_anew() {
    ++number_;
    beeps_ = 0;
    shown_ = false;
    next_steer_ = {};
}

Monitor ReplayProcess::monitor(SessionTime now) const {
    const double time_s = clock_.time_s(now);
    const TrialRecord& record = trial_->record;
    Monitor m;
    copy_state(trial_->at(time_s), m);
    m.time_s = time_s;
    m.position_fixture_m = record.conditions.fixture_position_m;
    m.network_delay_s = trial_->delay_s(time_s);
    m.network = trial_->network(time_s);
    m.accepted = visual_.accepted;
    m.refused = visual_.refused;
    m.subject = record.conditions.subject;
    m.modality = record.conditions.modality;
    m.state = shown_ ? NodeState::kRunning : NodeState::kIdle;
    m.reason = clock_.at_end(now) ? record.reason : EndReason::kNone;
    m.beeped = time_s >= record.beep_time_s;
    m.paused = !wants_to_run_;
    return m;
}

ReplayState replay_state_of(const RecordedTrial& trial) {
    ReplayState state;
    state.duration_s = trial.duration_s();
    const auto& samples = trial.record.samples;
    const auto touch = std::find_if(samples.begin(), samples.end(), [](const TrajectorySample& sample) {
        return sample.phase != TissuePhase::kFree;
    });
    if (touch != samples.end()) state.contact_s = touch->time_s;
    if (!std::isnan(trial.record.beep_time_s)) state.beep_s = trial.record.beep_time_s;
    double last_s = -state.duration_s;
    for (const NetworkEvent& event : trial.record.network_events) {
        const bool begins_with_it = event.time_s <= 0;
        if (begins_with_it || event.time_s - last_s < state.duration_s / 100) continue;
        if (state.changes == state.change_s.size()) break;
        last_s = state.change_s[state.changes++] = event.time_s;
    }
    return state;
}

void ReplayProcess::shut_down(SessionTime now) {
    SessionControl order;
    order.kind = ControlKind::kShutdown;
    control_.send(now, number_, order);
}

}  // namespace thimble
