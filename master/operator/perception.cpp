#include "master/operator/perception.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/portable.hpp"

namespace thimble {
namespace {

double weber_fraction(const PerceptionParameters& parameters, Modality modality) {
    switch (modality) {
        case Modality::kHF:
            return parameters.weber_handle;
        case Modality::kVF:
            return parameters.weber_visual;
        default:
            return parameters.weber_cutaneous;
    }
}

double full_scale_N(const PerceptionParameters& parameters, Modality modality) {
    switch (modality) {
        case Modality::kHF:
            return parameters.full_scale_handle_N;
        case Modality::kVF:
            return parameters.full_scale_bar_N;
        default:
            return parameters.full_scale_cutaneous_N;
    }
}

double reaction_s(const ReactionParameters& parameters, Modality modality) {
    switch (modality) {
        case Modality::kHF:
            return parameters.handle_s;
        case Modality::kCF:
            return parameters.cutaneous_s;
        case Modality::kCCF:
            return parameters.tactile_s + parameters.crossing_s + parameters.compatibility_s;
        default:
            return parameters.visual_s;
    }
}

enum class Sense : std::uint8_t { kJoints, kSkin, kEyes };

Sense sense_of(Modality modality) {
    if (modality == Modality::kVF) return Sense::kEyes;
    return modality == Modality::kHF ? Sense::kJoints : Sense::kSkin;
}

// Drawn: a trial is run by itself, and in a shuffled order the one before it is any of the four.
double drawn_switch_s(const ReactionParameters& parameters, const OperatorTask& task) {
    if (task.trial <= 1) return 0;
    RandomStream random(stream_key(task, Purpose::kPreviousModality));
    const auto before = static_cast<std::size_t>(random.uniform() * static_cast<double>(kModalityCount));
    return switch_cost_s(parameters, kModalities.at(std::min(before, kModalityCount - 1)), task.modality);
}

}  // namespace

double switch_cost_s(const ReactionParameters& parameters, Modality before, Modality now) {
    const bool other_hand = (before == Modality::kCCF) != (now == Modality::kCCF) && now != Modality::kVF;
    return (sense_of(before) != sense_of(now) ? parameters.switch_modality_s : 0) +
           (other_hand ? parameters.switch_hand_s : 0);
}

StreamKey stream_key(const OperatorTask& task, Purpose purpose) {
    return {task.study_seed, task.experiment, task.subject, task.trial, purpose};
}

Perception::Perception(const PerceptionParameters& parameters, const Subject& subject,
                       const OperatorTask& task)
    : modality_(task.modality),
      weber_(weber_fraction(parameters, task.modality)),
      criterion_N_(std::min(subject.criterion_N,
                            parameters.criterion_cap_fraction * full_scale_N(parameters, task.modality))),
      lost_N_(parameters.lost_N),
      lost_after_(brain_ticks(parameters.lost_after_s)),
      noise_(stream_key(task, Purpose::kPerception), parameters.weber_correlation_s, kBrainTick) {}

double Perception::stimulus_N(double force_hand_N, const Percept& percept) const {
    switch (modality_) {
        case Modality::
            kHF:  // and skin, where a compensator presses a part of the force there (docs/compensators.md)
            return force_hand_N + percept.force_N;
        case Modality::kVF:
            return percept.bar_N;
        default:
            return percept.force_N;
    }
}

Sensation Perception::sense(double force_hand_N, const Percept& percept) {
    const double stimulus_N = this->stimulus_N(force_hand_N, percept);
    // The noise multiplies: without a stimulus it need not be drawn.
    const double signal_N = stimulus_N == 0 ? 0 : stimulus_N * (1 + weber_ * noise_.next());
    below_ = signal_N < lost_N_ ? below_ + 1 : 0;
    return {signal_N, signal_N > criterion_N_, below_ > lost_after_};
}

ReactionTimes::ReactionTimes(const ReactionParameters& parameters, const Subject& subject,
                             const OperatorTask& task)
    : sigma_(std::sqrt(portable::log1p(parameters.trial_variation * parameters.trial_variation))),
      fixture_s_(reaction_s(parameters, task.modality) * subject.reaction_factor *
                 subject.reaction_modality_factor[static_cast<std::size_t>(task.modality)]),
      touch_s_(parameters.visual_s * subject.reaction_factor),
      beep_s_(parameters.auditory_s * subject.reaction_factor),
      switch_s_(drawn_switch_s(parameters, task) * subject.reaction_factor),
      random_(stream_key(task, Purpose::kReaction)) {}

std::int64_t ReactionTimes::draw(double median_s) {
    return brain_ticks(median_s * portable::exp(sigma_ * random_.normal() - 0.5 * sigma_ * sigma_));
}

}  // namespace thimble
