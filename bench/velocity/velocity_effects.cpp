#include "bench/velocity/velocity_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "slave_sim/slave_node.hpp"

namespace thimble {
namespace {

constexpr std::array kPressSpeeds_m_per_s{0.005, 0.010, 0.015};
constexpr double kForceSpeed_m_per_s = 0.010;
constexpr double kEntrySpeed_m_per_s = 0.060;
constexpr double kRun_m = 0.012;      // above the surface: a second's way for most speeds
constexpr double kFalse_m = 0.001;    // a puncture closer to touch than this is false
constexpr double kShortest_s = 0.25;  // of a contact whose force is judged
constexpr double kNever_m = std::numeric_limits<double>::quiet_NaN();
constexpr double kFixtureDamping_Ns_per_m = 5;

// One needle through the tissue, sample by sample.
struct Course {
    std::vector<double> force_N;
    std::vector<std::size_t> transitions;  // in the step that ends at this sample
    std::size_t punctured_at = std::numeric_limits<std::size_t>::max();
};

Course drive(const SampledNeedle& needle, const std::vector<double>& smooth_m) {
    SlaveNode slave{SlaveSettings{}};
    SessionControl order;
    order.fixture_present = false;
    slave.start_trial(order);
    Course course;
    for (std::size_t k = 0; k < needle.times.size(); ++k) {
        NeedleCommand command;
        command.position_needle_m = needle.encoder_m[k];
        command.position_needle_estimate_m = smooth_m[k];
        const ForceFeedback feedback =
            slave.on_needle(needle.times[k], static_cast<std::uint32_t>(k), command);
        course.force_N.push_back(feedback.force_tissue_N);
        course.transitions.push_back(slave.events().size());
        for (const Transition& event : slave.events()) {
            if (event.phase == to_string(TissuePhase::kPenetrated))
                course.punctured_at = std::min(course.punctured_at, k);
        }
    }
    return course;
}

struct Courses {
    Course ideal, estimated;
};

Courses drive_both(const VelocitySettings& settings, const SampledNeedle& needle) {
    std::vector<double> truth_m, smooth_m;
    for (const NeedleState& state : needle.truth) truth_m.push_back(state.position_m);
    for (const auto& e : estimate(settings, needle)) smooth_m.push_back(e.position_estimate_m);
    return {drive(needle, truth_m), drive(needle, smooth_m)};
}

double surface_m() { return SlaveSettings{}.scene.elements.front().position_m; }

double depth_m(const SampledNeedle& needle, const Course& course) {
    if (course.punctured_at >= needle.truth.size()) return kNever_m;
    return needle.truth[course.punctured_at].position_m - surface_m();
}

// A line from above the surface, at a place within the quantum and a speed that differ from run to run.
SampledNeedle approach(double nominal_m_per_s, double depth_m, const VelocityStudy& study,
                       RandomStream& random) {
    const double speed = nominal_m_per_s * random.uniform(0.98, 1.02);
    const double start_m = surface_m() - kRun_m + random.uniform(0, study.encoder.quantum_m);
    return sample(line(start_m, speed), (kRun_m + depth_m) / speed, study.encoder, random);
}

std::size_t touched_at(const SampledNeedle& needle) {
    const auto touch = std::find_if(needle.truth.begin(), needle.truth.end(),
                                    [](const NeedleState& s) { return s.position_m >= surface_m(); });
    return static_cast<std::size_t>(touch - needle.truth.begin());
}

struct ForceNoise {
    double sum = 0;
    std::size_t count = 0;
    void add(const Courses& courses, std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
            const double error_N = courses.estimated.force_N[k] - courses.ideal.force_N[k];
            sum += error_N * error_N;
            ++count;
        }
    }
    double rms_N() const { return count == 0 ? kNever_m : std::sqrt(sum / static_cast<double>(count)); }
};

}  // namespace

PressEffect measure_presses(const VelocitySettings& settings, const VelocityStudy& study) {
    RandomStream random = study.random(5);
    const SlaveSettings paper;
    const TissueParameters tissue = NeedleScene(paper.scene, paper.make_tissue).surface()->parameters();
    PressEffect effect;
    ForceNoise noise;
    const auto shortest = static_cast<std::size_t>(kShortest_s / to_seconds(study.encoder.period));
    for (const double speed : kPressSpeeds_m_per_s) {
        // Beyond the depth at which even the slowest of the runs pierces.
        const double deepest_m =
            (tissue.puncture_force_N - 0.9 * tissue.damping_Ns_per_m * speed) / tissue.stiffness_N_per_m;
        for (int i = 0; i < study.repeats; ++i) {
            const SampledNeedle needle = approach(speed, deepest_m, study, random);
            const Courses courses = drive_both(settings, needle);
            const double ideal_m = depth_m(needle, courses.ideal);
            const double error_m = depth_m(needle, courses.estimated) - ideal_m;
            ++effect.presses;
            if (error_m + ideal_m < kFalse_m) ++effect.false_punctures;
            effect.depth_error_mean_m += error_m;
            effect.ideal_depth_m += ideal_m;
            if (std::abs(error_m) > std::abs(effect.depth_error_worst_m))
                effect.depth_error_worst_m = error_m;
            const std::size_t from = touched_at(needle) + shortest / 2;
            const std::size_t to = std::min(courses.ideal.punctured_at, courses.estimated.punctured_at);
            if (speed == kForceSpeed_m_per_s && to > from + shortest / 2) noise.add(courses, from, to);
        }
    }
    effect.depth_error_mean_m /= effect.presses;
    effect.ideal_depth_m /= effect.presses;
    effect.contact_force_noise_N = noise.rms_N();
    return effect;
}

EntryEffect measure_entry(const VelocitySettings& settings, const VelocityStudy& study) {
    RandomStream random = study.random(6);
    EntryEffect effect;
    ForceNoise noise;
    const double per_s = 1 / to_seconds(study.encoder.period);
    const auto after = [&](double time_s) { return static_cast<std::size_t>(time_s * per_s); };
    for (int i = 0; i < study.repeats; ++i) {
        const SampledNeedle needle = approach(kEntrySpeed_m_per_s, 1.1 * kEntrySpeed_m_per_s, study, random);
        const Courses courses = drive_both(settings, needle);
        const std::size_t touch = touched_at(needle);
        effect.depth_error_m += depth_m(needle, courses.estimated) - depth_m(needle, courses.ideal);
        for (std::size_t k = touch; k < touch + after(0.2); ++k) {
            effect.transitions += static_cast<double>(courses.estimated.transitions[k]);
            effect.ideal_transitions += static_cast<double>(courses.ideal.transitions[k]);
        }
        noise.add(courses, touch + after(0.5), touch + after(1));
    }
    effect.depth_error_m /= study.repeats;
    effect.transitions /= study.repeats;
    effect.ideal_transitions /= study.repeats;
    effect.force_noise_N = noise.rms_N();
    return effect;
}

FixtureEffect fixture_effect(const TremorResponse& tremor) {
    const double rate = 2 * std::numbers::pi * kTremor_Hz;
    return {kFixtureDamping_Ns_per_m * tremor.noise_rms_m_per_s, tremor.gain * std::cos(tremor.phase_lag_rad),
            kFixtureDamping_Ns_per_m * rate * tremor.gain * std::sin(tremor.phase_lag_rad)};
}

}  // namespace thimble
