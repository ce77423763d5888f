#include "study/swarm/watch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "netem/link_settings.hpp"
#include "study/swarm/swarm_case.hpp"

namespace thimble {
namespace {

constexpr Duration kSlack = std::chrono::milliseconds{2};
constexpr double kRounding = 1e-9;
// A stop is repeated every 50 ms. A program that was started since hears of it within 500 ms.
constexpr Duration kStopReaches = 3 * kStopRepeat, kStopReachesNew = kStopPassedOn + 3 * kStopRepeat;

const ForceFeedback* force_in(const Message& message) {
    if (const auto* wave = std::get_if<ForceWave>(&message.body)) return &wave->feedback;
    return std::get_if<ForceFeedback>(&message.body);
}

bool no_force(const ForceFeedback& f) {
    return f.force_total_N == 0 && f.force_tissue_N == 0 && f.force_fixture_N == 0;
}

bool all_finite(std::initializer_list<double> values) {
    return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace

Watch::Watch(const SystemSettings& settings, bool unreadable) : settings_(settings), unreadable_(unreadable) {
    allow_delay(session_settings(settings).network_delay);
}

void Watch::begin_trial(const TrialConditions& conditions) {
    modality_ = conditions.modality;
    trial_ = conditions.trial;
    last_sample_s_ = -1;
}

void Watch::fail(Rule rule, std::string text) { verdict_.fail(rule, now(), std::move(text)); }

void Watch::freeze(Role role) {
    of(role).frozen = true;
    frozen_at_ = now();
}

void Watch::run_again(Role role, bool anew) {
    Program& program = of(role);
    stood_still_ += now() - frozen_at_;
    program.frozen = false;
    program.since = now();
    if (!anew) return;
    program.stopped = false;
    program.new_instance = true;
    if (role == Role::kSlaveSim) forget_needle();  // it holds nothing before its first command
}

void Watch::release() {
    released_ = true;
    none_held_since_ = kNever;
}

// Turned, because a multiplication alone never brings a high bit down: two changes of a sign would cancel.
void Watch::mix(std::initializer_list<double> numbers) {
    for (const double number : numbers)
        digest_ = std::rotl((digest_ ^ std::bit_cast<std::uint64_t>(number)) * 0x100000001b3U, 29);
}

void Watch::disturb(Port port) {
    if (std::find(kStopPorts.begin(), kStopPorts.end(), port) != kStopPorts.end()) buses_disturbed_ = true;
}

void Watch::handle_commanded(SessionTime now, double force_N) {
    mix({force_N});
    const GuardSettings& guard = settings_.master.guard;
    if (!std::isfinite(force_N) || std::abs(force_N) > guard.force_limit_N)
        fail(Rule::kForceLimit, fmt::format("{} N", force_N));
    // All forces of one instant grow from the force before it.
    if (now != commanded_at_) {
        before_N_ = handle_N_;
        grown_ = std::min<Duration>(now - commanded_at_, settings_.master.sample_period);
    }
    const double before_N = before_N_ * force_N > 0 ? std::abs(before_N_) : 0;
    const double most_N = before_N + guard.force_rate_limit_N_per_s * to_seconds(grown_);
    if (guard.force_rate_limit_N_per_s > 0 && std::abs(force_N) > most_N * (1 + kRounding) + kRounding)
        fail(Rule::kForceRate, fmt::format("{} N after {} N", force_N, before_N_));
    if (force_N != 0 && modality_ != Modality::kHF)
        fail(Rule::kForceModality, fmt::format("{} N in {}", force_N, to_string(modality_)));
    if (force_N != 0 && gave_too_much_) fail(Rule::kGuardEnergy, fmt::format("{} N", force_N));
    handle_N_ = force_N;
    commanded_at_ = now;
}

void Watch::handle_enabled() {
    energy_.clear();
    highest_J_.clear();
    gave_too_much_ = false;
}

void Watch::handle_read(SessionTime now, const HandleSample& sample) {
    const GuardSettings& guard = settings_.master.guard;
    if (guard.energy_limit_J <= 0 || !sample.valid) return;
    energy_.add(sample.position_hand_m, sample.force_hand_N);
    const double energy_J = energy_.energy_in_J();
    while (!highest_J_.empty() && highest_J_.back().energy_J <= energy_J) highest_J_.pop_back();
    highest_J_.push_back({now, energy_J});
    while (now - highest_J_.front().at >= guard.energy_window) highest_J_.pop_front();
    const double given_out_J = highest_J_.front().energy_J - energy_J;
    if (given_out_J > guard.energy_limit_J * (1 + kRounding)) gave_too_much_ = true;
}

void Watch::finger_commanded(SessionTime /*now*/, double force_N) {
    mix({force_N});
    if (!std::isfinite(force_N) || force_N < 0 || force_N > settings_.cutaneous.guard_limit_N)
        fail(Rule::kFingerLimit, fmt::format("{} N commanded", force_N));
    const bool wears = modality_ == Modality::kCF || modality_ == Modality::kCCF ||
                       (modality_ == Modality::kHF && settings_.cutaneous.hand_share < 1);
    if (force_N != 0 && !wears)
        fail(Rule::kFingerModality, fmt::format("{} N in {}", force_N, to_string(modality_)));
    finger_N_ = force_N;
}

void Watch::finger_felt(double force_N) {
    const double most_N = std::min(settings_.cutaneous.force_limit_N, settings_.cutaneous.guard_limit_N);
    if (!std::isfinite(force_N) || force_N < 0 || force_N > most_N)
        fail(Rule::kFingerLimit, fmt::format("{} N felt", force_N));
}

void Watch::bar_drawn(SessionTime /*now*/, const Scene& scene) {
    bar_N_ = scene.bar_N;
    mix({scene.bar_N, scene.position_needle_m, scene.position_surface_m, scene.fingertip_N});
    const bool numbers =
        all_finite({scene.bar_N, scene.position_needle_m, scene.position_surface_m, scene.fingertip_N});
    if (!numbers || scene.bar_N < 0) fail(Rule::kBarSilence, fmt::format("the bar shows {} N", scene.bar_N));
    if (scene.bar_N != 0 && modality_ != Modality::kVF)
        fail(Rule::kBarSilence, fmt::format("the bar shows {} N in {}", scene.bar_N, to_string(modality_)));
    const Duration silent = silence(force_bar_, Role::kVisual);
    if (scene.bar_N != 0 && silent > most_silence(settings_.visual.stale) + kSlack)
        fail(Rule::kBarSilence, fmt::format("{} N, {} s after the last force", bar_N_, to_seconds(silent)));
}

void Watch::sample_recorded(const TrajectorySample& s) {
    mix({s.time_s, s.position_needle_m, s.position_surface_m, s.force_tissue_N, s.force_fixture_N,
         s.force_total_N, s.contact_time_s});
    const bool numbers = all_finite({s.time_s, s.position_needle_m, s.position_surface_m, s.force_tissue_N,
                                     s.force_fixture_N, s.force_total_N, s.contact_time_s});
    const bool back =
        s.time_s < last_sample_s_ && !unreadable_;  // flipped bits of a stamp put one sample ahead
    if (!numbers || back || s.time_s == last_sample_s_)
        fail(Rule::kRecordFinite,
             fmt::format("a sample at {} s after one at {} s", s.time_s, last_sample_s_));
    last_sample_s_ = s.time_s;
}

void Watch::sent(Port to, Bytes datagram) {
    if (to != Port::kSessionRecord || unreadable_) return;
    const Decoded decoded = decode(datagram);
    const auto* feedback = decoded.message ? std::get_if<ForceFeedback>(&decoded.message->body) : nullptr;
    if (feedback == nullptr)
        return forget_needle();  // it is beyond reason; all inputs refuse it and fall silent
    hear_needle(*feedback, decoded.message->header.trial);
}

void Watch::forget_needle() {
    newest_ = {};
    newest_trial_ = 0;
}

void Watch::hear_needle(const ForceFeedback& feedback, std::uint32_t trial) {
    if (feedback.needle_held && !no_force(feedback))
        fail(Rule::kHeldNeedle, "a needle that is held has a force");
    const bool again = feedback.needle_held && newest_.needle_held && trial == newest_trial_;
    if (again && feedback.position_needle_m != newest_.position_needle_m)
        fail(Rule::kHeldNeedle, "a needle that is held moved");
    newest_ = feedback;
    newest_trial_ = trial;
}

void Watch::arrived(Port to, Bytes datagram) {
    InputNews* input = to == Port::kMasterForce      ? &force_handle_
                       : to == Port::kCutaneousForce ? &force_finger_
                       : to == Port::kVisualForce    ? &force_bar_
                       : to == Port::kSlaveNeedle    ? &needle_
                                                     : nullptr;
    if (input == nullptr) return;
    if (unreadable_) {
        input->at = now();
        return;
    }
    const Decoded decoded = decode(datagram);
    if (!decoded.message) return;
    input->hear(now(), decoded.message->header);
    if (to == Port::kMasterForce) hear_force(*decoded.message);
}

void Watch::hear_force(const Message& message) {
    const ForceFeedback* force = force_in(message);
    if (force == nullptr) return;
    newest_echo_ = std::max(newest_echo_, force->needle_held ? now() : force->echo_time);
    forces_.push_back({now(), -settings_.master.force_scale * force->force_total_N});
    lowest_N_ = std::min(lowest_N_, forces_.back().force_N);
    highest_N_ = std::max(highest_N_, forces_.back().force_N);
    // One that came may be too old, and then an earlier one goes on.
    const Duration acts =
        most_silence(settings_.master.stale) + settings_.master.sample_period + stood_still_;
    while (now() - forces_.front().at > acts + kSlack) forces_.pop_front();
}

Duration Watch::silence(const InputNews& input, Role role) {
    // The first one takes as long as the network.
    const SessionTime first = began_.at(static_cast<std::size_t>(role)) + allowed_;
    return now() - std::max({input.at, of(role).since, first});
}

void Watch::watch_begin() {
    for (const Role role : kNodeRoles) {
        const auto i = static_cast<std::size_t>(role);
        const bool runs = session_->node(role).state() == NodeState::kRunning;
        if (runs && !runs_.at(i)) began_.at(i) = now();
        runs_.at(i) = runs;
    }
}

// With "hold" the trial ends, once all peers were heard again.
Duration Watch::most_silence(const StalePolicy& policy) const {
    if (policy.mode == StaleMode::kHold) return kPeerTimeout + kHeartbeatPeriod + allowed_ + stood_still_;
    return policy.after + (policy.mode == StaleMode::kRamp ? policy.ramp : Duration{});
}

// A line through two forces goes on by no more than the deadband or their difference (common/reduction/force_codec.hpp).
bool Watch::covers(const Force& force) const {
    const CodecSettings& codec = settings_.master.codec;
    const double sent_N = std::abs(force.force_N);
    double most_N = sent_N;
    if (codec.force == HapticCodec::kDeadbandLinear)
        most_N += std::max(
            highest_N_ - lowest_N_,
            codec.weber_fraction * std::max(sent_N, settings_.master.force_scale * codec.force_floor_N));
    return std::signbit(force.force_N) == std::signbit(handle_N_) &&
           std::abs(handle_N_) <= most_N * (1 + kRounding);
}

void Watch::watch_handle() {
    if (handle_N_ == 0 || of(Role::kMaster).frozen) return;
    const StalePolicy& policy = settings_.master.stale;
    const Duration most = most_silence(policy) + settings_.master.sample_period + kSlack;
    const Duration silent = silence(force_handle_, Role::kMaster);
    if (silent > most)
        fail(Rule::kForceSilence,
             fmt::format("{} N, {} s after the last force", handle_N_, to_seconds(silent)));
    if (unreadable_) return;
    const Duration oldest = std::max(allowed_, settings_.master.oldest_force);
    const SessionTime began = began_.at(static_cast<std::size_t>(Role::kMaster));
    const Duration age = now() - std::max({newest_echo_, of(Role::kMaster).since, began});
    if (policy.mode != StaleMode::kHold && age > oldest + most)
        fail(Rule::kForceAge,
             fmt::format("{} N, from a sample that is {} s old", handle_N_, to_seconds(age)));
    const bool plain = settings_.master.control.compensator == Compensator::kNone;
    if (plain &&
        std::none_of(forces_.rbegin(), forces_.rend(), [this](const Force& force) { return covers(force); }))
        fail(Rule::kForceSent, fmt::format("{} N", handle_N_));
}

void Watch::watch_finger() {
    if (finger_N_ == 0 || of(Role::kCutaneous).frozen) return;
    const CutaneousSettings& s = settings_.cutaneous;
    const Duration silent = silence(force_finger_, Role::kCutaneous);
    if (silent > most_silence(s.stale) + s.percept_period + kSlack)
        fail(Rule::kFingerSilence,
             fmt::format("{} N, {} s after the last force", finger_N_, to_seconds(silent)));
}

void Watch::watch_needle() {
    if (unreadable_ || of(Role::kSlaveSim).frozen || newest_.needle_held || newest_trial_ != trial_) return;
    if (session_->slave().state() != NodeState::kRunning) return;
    const Duration silent = silence(needle_, Role::kSlaveSim);
    if (silent > settings_.slave.stale_after + kSlack)
        fail(Rule::kHeldNeedle,
             fmt::format("the needle is not held, {} s after the last command", to_seconds(silent)));
}

const StopBus& Watch::bus(Role role) const {
    return role == Role::kSession ? session_->session().stop_bus() : session_->node(role).stop_bus();
}

void Watch::watch_rest(Role role) {
    const bool runs = role != Role::kSession && session_->node(role).state() == NodeState::kRunning;
    const bool pushes =
        (role == Role::kMaster && handle_N_ != 0) || (role == Role::kCutaneous && finger_N_ != 0);
    if (runs || pushes)
        fail(Rule::kStopRests, fmt::format("{} {}", to_string(role), runs ? "runs a trial" : "pushes"));
}

// True if a running program holds one.
bool Watch::look_for_stops() {
    bool any = false;
    for (const Role role : kSwarmPrograms) {
        Program& program = of(role);
        const bool stopped = bus(role).stopped();
        if (program.stopped && !stopped && !released_)
            fail(Rule::kStopHolds, fmt::format("{} released it", to_string(role)));
        program.stopped = stopped;
        if (!stopped || program.frozen) continue;
        any = true;
        watch_rest(role);
    }
    return any;
}

// The next stop must hold again. A datagram that was held up may bring the old stop and its release once more: until none can,
// the release counts.
void Watch::forget_release() {
    const bool asleep =
        std::any_of(programs_.begin(), programs_.end(), [](const Program& one) { return one.frozen; });
    if (!released_ || asleep || buses_disturbed_) return;
    none_held_since_ = std::min(none_held_since_, now());
    if (now() - none_held_since_ > kStopReachesNew) released_ = false;
}

void Watch::watch_stops() {
    if (!look_for_stops()) {
        stop_since_ = kNever;
        forget_release();
        for (Program& program : programs_) program.new_instance = false;
        return;
    }
    none_held_since_ = kNever;
    stop_since_ = std::min(stop_since_, now());
    if (buses_disturbed_ || released_) return;
    for (const Role role : kSwarmPrograms) {
        const Program& program = of(role);
        const Duration most = program.new_instance ? kStopReachesNew : kStopReaches;
        const bool late = now() - std::max(stop_since_, program.since) > most;
        if (!program.frozen && !program.stopped && late)
            fail(Rule::kStopReaches, fmt::format("{} did not receive it", to_string(role)));
    }
}

void Watch::instant() {
    watch_begin();
    watch_handle();
    watch_finger();
    watch_needle();
    watch_stops();
}

// A program that ran again only now still listens for the others.
bool Watch::has_settled(Role role) {
    return !of(role).frozen && now() - of(role).since > kPeerTimeout + kHeartbeatPeriod;
}

void Watch::rests() {
    if (handle_N_ != 0 && has_settled(Role::kMaster))
        fail(Rule::kRestAfter, fmt::format("{} N at the handle", handle_N_));
    if (finger_N_ != 0 && has_settled(Role::kCutaneous))
        fail(Rule::kRestAfter, fmt::format("{} N at a finger", finger_N_));
    if (!unreadable_ && !no_force(newest_) && has_settled(Role::kSlaveSim))
        fail(Rule::kRestAfter, "a force in slave_sim");
}

void Watch::count() {
    for (const Relay& relay : session_->netem().relays()) {
        const LinkCounters& c = relay.model.counters();
        const std::uint64_t gone =
            c.lost + c.outage + c.oversized + c.queue_full + c.overflowed + c.delivered;
        if (c.pushed + c.duplicated != gone + relay.model.in_flight())
            fail(Rule::kCountsAddUp, fmt::format("{} arrived, {} left, {} are on their way",
                                                 c.pushed + c.duplicated, gone, relay.model.in_flight()));
    }
}

}  // namespace thimble
