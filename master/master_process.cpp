#include "master/master_process.hpp"

#include <algorithm>

namespace thimble {

MasterProcess::MasterProcess(std::uint64_t instance, const MasterSettings& settings, const Channels& channels,
                             HapticDevice& device, OperatorPort& person)
    : NodeProcess(Role::kMaster, instance, *channels.control),
      channels_(channels),
      node_(settings),
      guard_(settings.guard, settings.sample_period),
      device_(&device),
      person_(&person),
      needle_flow_(Role::kMaster, instance, {channels.needle_out}) {}

MasterProcess::MasterProcess(std::uint64_t instance, const MasterSettings& settings, Ports& ports,
                             HapticDevice& device, OperatorPort& person, HandFollower* follower)
    : MasterProcess(instance, settings,
                    {ports.between(Port::kMasterControl, Port::kSessionMaster),
                     ports.outlet(Port::kNetemNeedle), ports.inlet(Port::kMasterForce),
                     ports.inlet(Port::kMasterPerceptCutaneous), ports.inlet(Port::kMasterPerceptVisual)},
                    device, person) {
    join_stop_bus(ports);
    if (follower != nullptr) follow_hand(*ports.inlet(Port::kMasterHand), *follower);
}

void MasterProcess::follow_hand(Channel& hand_in, HandFollower& follower) {
    hand_in_ = &hand_in;
    follower_ = &follower;
}

void MasterProcess::begin_trial(SessionTime now, const SessionControl& control) {
    node_.start_trial(control.modality, first_answer_within(control));
    guard_.clear(now);
    asked_force_N_ = 0;
    person_->start_trial(
        now, {control.study_seed, control.experiment, control.subject, trial(), control.modality});
    device_->enable_force(now, control.modality == Modality::kHF);
    force_flow_.expect_from(now + first_answer_within(control));
    age_.begin(now, longest_age(first_answer_within(control)));
    round_trip_.clear();
    newest_age_ = {};
    energy_.clear();
    percept_ = {};
    next_sample_ = now;
}

void MasterProcess::end_trial(SessionTime now) {
    stale_record_.end(now);
    device_->command_force(now, 0);
    device_->enable_force(now, false);
    node_.end_trial();
}

// Read, send, and only then look at what came in: see master_node.hpp for why the order is fixed.
void MasterProcess::work(SessionTime now) {
    take_hand(now);
    take_percepts(now);
    if (running() && now >= next_sample_) sample(now);
    take_forces(now);
}

void MasterProcess::take_hand(SessionTime now) {
    if (hand_in_ == nullptr) return;
    hand_flow_.drain<HandInput>(
        now, *hand_in_, running(), trial(),
        [&](const Header&, const HandInput& input) { follower_->follow(now, input); });
}

// Skin and eyes report separately and at different rates; the operator gets the newest of both.
void MasterProcess::take_percepts(SessionTime now) {
    cutaneous_flow_.drain<Percept>(now, *channels_.percept_cutaneous, running(), trial(),
                                   [&](const Header&, const Percept& skin) {
                                       percept_.force_N = skin.force_N;
                                       percept_.finger = skin.finger;
                                       person_->perceive(now, percept_);
                                   });
    visual_flow_.drain<Percept>(now, *channels_.percept_visual, running(), trial(),
                                [&](const Header&, const Percept& eyes) {
                                    const double force_N = percept_.force_N;
                                    const Finger finger = percept_.finger;
                                    percept_ = eyes;
                                    percept_.force_N = force_N;
                                    percept_.finger = finger;
                                    person_->perceive(now, percept_);
                                });
}

void MasterProcess::take_forces(SessionTime now) {
    if (node_.control().waves()) {
        force_flow_.drain<ForceWave>(now, *channels_.force_in, running(), trial(),
                                     [&](const Header&, const ForceWave& wave) {
                                         node_.control().take(wave.waves);
                                         take_force(now, wave.feedback);
                                     });
    } else {
        force_flow_.drain<ForceFeedback>(
            now, *channels_.force_in, running(), trial(),
            [&](const Header&, const ForceFeedback& feedback) { take_force(now, feedback); });
    }
    if (running()) fade(now);
}

void MasterProcess::take_force(SessionTime now, const ForceFeedback& feedback) {
    round_trip_.add(now, feedback);
    newest_age_ = now - feedback.echo_time;
    age_.take(feedback.needle_held ? now
                                   : feedback.echo_time);  // a held needle answers nothing, and has no force
    if (!node_.control().active()) {
        if (stood_still() || age_.late(now) >= node_.settings().stale.after) return;  // as if it had not come
        asked_force_N_ = node_.handle_force_N(feedback);
        return apply(now, share(now) * asked_force_N_);
    }
    node_.control().take(feedback);
    if (now == sampled_) apply(now, share(now) * node_.control().force_N());
}

Duration MasterProcess::longest_age(Duration network_delay) const {
    const Duration oldest = node_.settings().oldest_force;
    return oldest > Duration::zero() ? oldest : network_delay;
}

Duration MasterProcess::silence(SessionTime now) const {
    return std::max(now - force_flow_.last_accepted(), age_.late(now));
}

// How much of its force the handle is given: all of it while news come. A compensator that brakes by itself fades as well.
double MasterProcess::share(SessionTime now) const {
    return stood_still() ? 0 : node_.settings().stale.share(silence(now));
}

void MasterProcess::fade(SessionTime now) {
    if (stood_still()) asked_force_N_ = 0;
    const bool acts = stood_still() || node_.settings().stale.stale(silence(now));
    stale_record_.watch(now, trial(), acts);
    if (!acts) return;
    if (node_.control().active()) {
        node_.control().forget();
        if (share(now) == 0) apply(now, 0);
    } else {
        apply(now, asked_force_N_ * share(now));
    }
}

// Nothing reaches the handle but through the guard; what lets go of it (end_trial) needs none.
void MasterProcess::apply(SessionTime now, double force_hand_N) {
    device_->command_force(now, guard_.pass(now, resting() ? 0 : force_hand_N));
}

StopRequest MasterProcess::wants_stop(SessionTime now) {
    if (device_->take_stop(now)) return {EndReason::kEmergencyStop, "the stop button at the handle"};
    if (running() && guard_.tripped()) return {EndReason::kSafetyStop, guard_.words()};
    return {};
}

void MasterProcess::sample(SessionTime now) {
    const HandleSample handle = device_->read(now);
    guard_.observe(now, handle);
    if (handle.valid) {
        send_needle(now, node_.sample(now, handle));
        energy_.add(handle);
        sampled_ = now;
        if (node_.control().active()) apply(now, share(now) * node_.control().force_N());
        ++samples_;
    }
    next_sample_ += node_.settings().sample_period;
    // After a stall the missed samples are gone: a handle cannot be read in the past.
    while (next_sample_ <= now) {
        next_sample_ += node_.settings().sample_period;
        ++samples_skipped_;
    }
    if (state() == NodeState::kRunning && person_->finished()) set_state(NodeState::kFinished);
}

void MasterProcess::send_needle(SessionTime now, const NeedleCommand& command) {
    if (node_.control().waves()) {
        needle_flow_.send(now, trial(), NeedleWave{command, node_.control().burst()});
    } else {
        needle_flow_.send(now, trial(), command);
    }
}

void MasterProcess::add_counters(FlowCounters& sum) const {
    for (const InboundFlow* flow : {&force_flow_, &cutaneous_flow_, &visual_flow_, &hand_flow_})
        sum.add(flow->counters());
}

void MasterProcess::describe(Heartbeat& heartbeat) const {
    heartbeat.energy_in_J = energy_.energy_in_J();
    if (state() == NodeState::kRunning) {  // quantiles cost microseconds: only once the trial is over
        heartbeat.force_hand_N = energy_.force_hand_N();
        heartbeat.round_trip_median_s = to_seconds(newest_age_);
        return;
    }
    heartbeat.round_trip_median_s = to_seconds(round_trip_.age().quantile(0.5));
    heartbeat.round_trip_worst_s = to_seconds(round_trip_.age().worst());
    heartbeat.hold_median_s = to_seconds(round_trip_.hold().quantile(0.5));
}

}  // namespace thimble
