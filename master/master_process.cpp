#include "master/master_process.hpp"

namespace thimble {

MasterProcess::MasterProcess(std::uint64_t instance, const MasterSettings& settings, Ports& ports,
                             HapticDevice& device, OperatorPort& person, HandFollower* follower)
    : NodeProcess(Role::kMaster, instance, *ports.between(Port::kMasterControl, Port::kSessionMaster)),
      needle_flow_(Role::kMaster, instance, {ports.outlet(Port::kNetemNeedle)}),
      needle_gate_(settings.codec),
      force_in_(ports.inlet(Port::kMasterForce)),
      cutaneous_in_(ports.inlet(Port::kMasterPerceptCutaneous)),
      visual_in_(ports.inlet(Port::kMasterPerceptVisual)),
      node_(settings),
      handle_(settings.guard, settings.sample_period, device),
      person_(&person),
      follower_(follower) {
    join_stop_bus(ports);
    if (follower != nullptr) hand_in_ = ports.inlet(Port::kMasterHand);
}

void MasterProcess::begin_trial(SessionTime now, const SessionControl& control) {
    const Duration delay = first_answer_within(control);
    node_.start_trial(now, control.modality, delay);
    needle_gate_.reset();
    handle_.clear(now);
    person_->start_trial(
        now, {control.study_seed, control.experiment, control.subject, trial(), control.modality});
    handle_.enable_force(now, control.modality == Modality::kHF);
    force_flow_.expect_from(now + delay);
}

void MasterProcess::end_trial(SessionTime now) {
    stale_record_.end(now);
    handle_.command_force(now, 0);
    handle_.enable_force(now, false);
    node_.end_trial();
}

// Read, send, and only then look at what came in: see master_node.hpp for why the order is fixed.
void MasterProcess::work(SessionTime now) {
    node_.begin_tick(since_last_tick());
    take_hand(now);
    take_percepts(now);
    if (node_.take_due(now)) sample(now);
    take_forces(now);
}

// Each of a tick's parts is called in one place: the compiler makes one function of them.
inline void MasterProcess::take_hand(SessionTime now) {
    if (hand_in_ == nullptr) return;
    hand_flow_.drain<HandInput>(
        now, *hand_in_, running(), trial(),
        [&](const Header&, const HandInput& input) { follower_->follow(now, input); });
}

inline void MasterProcess::take_percepts(SessionTime now) {
    cutaneous_flow_.drain<Percept>(
        now, *cutaneous_in_, running(), trial(),
        [&](const Header&, const Percept& skin) { person_->perceive(now, node_.feel(skin)); });
    visual_flow_.drain<Percept>(
        now, *visual_in_, running(), trial(),
        [&](const Header&, const Percept& eyes) { person_->perceive(now, node_.see(eyes)); });
}

template <class Body>
inline void MasterProcess::take_forces_as(SessionTime now) {
    force_flow_.drain<Body>(now, *force_in_, running(), trial(),
                            [&](const Header&, const Body& body) { apply(now, node_.take(now, body)); });
}

inline void MasterProcess::take_forces(SessionTime now) {
    if (node_.has_waves()) {
        take_forces_as<ForceWave>(now);
    } else {
        take_forces_as<ForceFeedback>(now);
    }
    if (!running()) return;
    const bool stale = node_.stale(now);
    stale_record_.watch(now, trial(), stale);
    if (stale) apply(now, node_.fade(now));
}

void MasterProcess::apply(SessionTime now, std::optional<double> force_hand_N) {
    if (force_hand_N) handle_.command_force(now, resting() ? 0 : *force_hand_N);
}

StopRequest MasterProcess::wants_stop(SessionTime now) {
    if (handle_.take_stop(now)) return {EndReason::kEmergencyStop, "the stop button at the handle"};
    if (running() && handle_.tripped()) return {EndReason::kSafetyStop, handle_.text()};
    return {};
}

inline void MasterProcess::sample(SessionTime now) {
    const HandleSample handle = handle_.read(now);
    if (handle.valid) {
        send_needle(now, node_.sample(now, handle));
        apply(now, node_.force_at_sample_N(now));
    }
    if (state() == NodeState::kRunning && person_->finished()) set_state(NodeState::kFinished);
}

inline void MasterProcess::send_needle(SessionTime now, const NeedleCommand& command) {
    if (!needle_gate_.due(now, command)) return;
    if (node_.has_waves()) {
        needle_flow_.send(now, trial(), NeedleWave{command, node_.waves()});
    } else {
        needle_flow_.send(now, trial(), command);
    }
}

void MasterProcess::add_counters(FlowCounters& sum) const {
    for (const InboundFlow* flow : {&force_flow_, &cutaneous_flow_, &visual_flow_, &hand_flow_})
        sum.add(flow->counters());
}

void MasterProcess::describe(Heartbeat& heartbeat) const {
    heartbeat.energy_in_J = energy().energy_in_J();
    if (state() == NodeState::kRunning) {  // quantiles cost microseconds: only once the trial is over
        heartbeat.force_hand_N = node_.force_hand_N();
        heartbeat.round_trip_median_s = to_seconds(node_.newest_age());
        return;
    }
    heartbeat.round_trip_median_s = to_seconds(round_trip().age().quantile(0.5));
    heartbeat.round_trip_worst_s = to_seconds(round_trip().age().worst());
    heartbeat.hold_median_s = to_seconds(round_trip().hold().quantile(0.5));
}

}  // namespace thimble
