#include "master/master_node.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "master/velocity_settings.hpp"

namespace thimble {

namespace {

MasterSettings read_master_table(const ConfigTable& table) {
    MasterSettings s;
    read_scaling(table, s);
    s.stale = read_stale_policy(table, s.stale, s.sample_period, std::chrono::seconds{1});
    table.read("oldest_force_s", s.oldest_force, 0, 3600,
               "Older forces count as zero. Never less than the longest round-trip delay of the session's "
               "network.");
    s.velocity = read_velocity_settings(table, s.sample_period, s.position_scale);
    return s;
}

void require_sampled_window(const ConfigTable& guard, const MasterSettings& s) {
    if (s.guard.energy_limit_J == 0 || s.guard.energy_window >= 2 * s.sample_period) return;
    guard.fail("energy_window_s",
               "is {:g}, but must be at least twice [master] sample_period_s, {:g}: the guard would forget "
               "each sample before the next",
               to_seconds(s.guard.energy_window), to_seconds(s.sample_period));
}

}  // namespace

MasterSettings read_master_settings(const ConfigFile& file, const GuardSettings& guard) {
    MasterSettings s = read_master_table(file.table("master"));
    require_fresh_samples(file, "master", s.sample_period, s.stale.after);
    s.guard = read_guard_settings(file.table("guard"), guard);
    require_sampled_window(file.table("guard"), s);
    s.control = read_control_settings(file);
    s.codec = read_codec_settings(file.table("codec"));
    if (s.force_limit_N > s.guard.force_limit_N && file.table("master").has("force_limit_N")) {
        file.table("master").fail("force_limit_N",
                                  fmt::format("is {:g}, but the guard before the handle limits the force to "
                                              "{:g} N: to allow more, raise [guard] force_limit_N as well",
                                              s.force_limit_N, s.guard.force_limit_N));
    }
    return s;
}

MasterNode::MasterNode(const MasterSettings& settings)
    : settings_(settings),
      estimator_(settings.velocity),
      control_(settings.control, {settings.position_scale, settings.force_scale, settings.force_limit_N,
                                  settings.sample_period}),
      fill_(settings.codec, settings.sample_period) {}

void MasterNode::start_trial(SessionTime now, Modality modality, Duration network_delay) {
    control_.start(modality == Modality::kHF, network_delay);
    modality_ = modality;
    next_sample_ = now;
    sampled_ = kNever;
    heard_ = now + network_delay;
    age_.begin(now, longest_age(network_delay));
    asked_force_N_ = force_hand_N_ = 0;
    fill_.reset();
    percept_ = {};
    round_trip_.clear();
    newest_age_ = {};
}

void MasterNode::end_trial() {
    next_sample_ = kNever;
    control_.end();
}

void MasterNode::network_changed(Duration network_delay) {
    age_.allow(longest_age(network_delay));
    control_.network_changed(network_delay);
}

bool MasterNode::take_due(SessionTime now) {
    if (now < next_sample_) return false;
    next_sample_ += settings_.sample_period;
    // After a stall the missed samples are gone: a handle cannot be read in the past.
    for (; next_sample_ <= now; next_sample_ += settings_.sample_period) ++samples_skipped_;
    return true;
}

NeedleCommand MasterNode::sample(SessionTime now, const HandleSample& handle) {
    const double position_needle_m = settings_.position_scale * handle.position_hand_m;
    if (sampled_ == kNever) estimator_.reset(position_needle_m);
    sampled_ = now;
    ++samples_;
    force_hand_N_ = handle.force_hand_N;
    const auto estimate = estimator_.update(now, position_needle_m);
    const double velocity_hand_m_per_s = estimate.velocity_m_per_s / settings_.position_scale;
    if (control_.present()) control_.sample(now, handle, velocity_hand_m_per_s);
    NeedleCommand command;
    command.position_needle_m = position_needle_m;
    command.velocity_needle_m_per_s = estimate.velocity_m_per_s;
    command.position_needle_estimate_m = estimate.position_estimate_m;
    command.position_hand_m = handle.position_hand_m;
    command.velocity_hand_m_per_s = velocity_hand_m_per_s;
    command.force_hand_N = handle.force_hand_N;
    return command;
}

std::optional<double> MasterNode::force_at_sample_N(SessionTime now) {
    const bool predicts = fill_.predicts();
    if (predicts && control_.present()) control_.predict(fill_.at(now), heard_age_ + (now - heard_));
    if (control_.active()) return share(now) * control_.force_N(predicts ? Duration{} : now - heard_);
    if (!predicts) return std::nullopt;
    asked_force_N_ = handle_force_N(fill_.at(now));
    return share(now) * asked_force_N_;
}

std::optional<double> MasterNode::take(SessionTime now, const ForceWave& wave) {
    if (control_.present()) control_.take(wave.waves);
    return take(now, wave.feedback);
}

std::optional<double> MasterNode::take(SessionTime now, const ForceFeedback& feedback) {
    round_trip_.add(now, feedback);
    newest_age_ = now - feedback.echo_time;
    if (control_.present()) control_.take(feedback, newest_age_);
    // A held needle answers nothing, and has no force.
    const SessionTime made = feedback.needle_held ? now : feedback.echo_time;
    // As if it had not come: the force before it must fade, however many come late.
    if (!control_.active() && age_.late(now, made) >= settings_.stale.after) return std::nullopt;
    heard_ = now;
    heard_age_ = newest_age_;
    age_.take(made);
    fill_.heard(now, feedback);
    if (control_.active()) return now == sampled_ ? force_at_sample_N(now) : std::nullopt;
    if (stood_still_) return std::nullopt;
    asked_force_N_ = handle_force_N(feedback);
    return share(now) * asked_force_N_;
}

std::optional<double> MasterNode::fade(SessionTime now) {
    if (stood_still_) asked_force_N_ = 0;
    if (!stale(now)) return std::nullopt;
    fill_.reset();
    if (!control_.active()) return asked_force_N_ * share(now);
    control_.forget();
    return share(now) == 0 ? std::optional(0.0) : std::nullopt;
}

bool MasterNode::stale(SessionTime now) const { return stood_still_ || settings_.stale.stale(silence(now)); }

double MasterNode::handle_force_N(const ForceFeedback& feedback) {
    if (modality_ != Modality::kHF || feedback.needle_held) return 0;
    if (control_.present()) return control_.force_N();
    // Feedback acts on the operator along +z; the handle's force counts positive when it pushes out, along
    // -z.
    const double limit_N = settings_.force_limit_N;
    return std::clamp(-settings_.force_scale * feedback.force_total_N, -limit_N, limit_N);
}

// So old may a force become under a network that takes so long there and back.
Duration MasterNode::longest_age(Duration network_delay) const {
    return std::max(settings_.oldest_force, network_delay);
}

Duration MasterNode::silence(SessionTime now) const { return std::max(now - heard_, age_.late(now)); }

// How much of its force the handle is given: all of it while news come. A compensator that brakes by itself fades as well.
double MasterNode::share(SessionTime now) const {
    return stood_still_ ? 0 : settings_.stale.share(silence(now));
}

const Percept& MasterNode::feel(const Percept& skin) {
    percept_.force_N = skin.force_N;
    percept_.finger = skin.finger;
    return percept_;
}

const Percept& MasterNode::see(const Percept& eyes) {
    const Percept before = std::exchange(percept_, eyes);
    return feel(before);
}

}  // namespace thimble
