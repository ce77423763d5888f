#include "stability/loop_measures.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/math/portable.hpp"

namespace thimble {
namespace {

constexpr double kStart_m = 5e-3;  // of a linear run
constexpr double kRun_s = 6, kDelays = 60;
// After long delays many modes grow almost alike, and the first takes this long to stand out.
constexpr double kLong_s = 0.5, kLongDelays = 400;
constexpr double kGrown = 1e60;  // beyond, the rest of the trace has no use
constexpr double kFaded = 1e-60;
constexpr double kWatched_s = 3;     // the last of a hold
constexpr double kQuantaLeft = 100;  // of amplitude, for an encoder not to matter

struct ZeroCrossings {
    std::size_t first = 0, last = 0, count = 0;
};

ZeroCrossings zero_crossings(std::span<const double> trace) {
    ZeroCrossings z;
    for (std::size_t i = 1; i < trace.size(); ++i) {
        if ((trace[i - 1] > 0) == (trace[i] > 0)) continue;
        if (z.count == 0) z.first = i;
        z.last = i;
        ++z.count;
    }
    return z;
}

// Sampled positions, from the start until they have become uselessly large or small.
std::vector<double> linear_run(const LoopConditions& conditions) {
    const SampledLoop& loop = conditions.loop;
    const auto samples = static_cast<std::size_t>(
        std::max(kRun_s, (loop.delay_s > kLong_s ? kLongDelays : kDelays) * loop.delay_s) / loop.step_s);
    LoopSimulator run(conditions, kStart_m, 0);
    const double least_m = std::max(kFaded, kQuantaLeft * conditions.encoder_step_m);
    std::vector<double> trace;
    trace.reserve(samples);
    double swing_m = 0;  // greatest within a window
    const std::size_t window = std::max<std::size_t>(64, samples / 8);
    for (std::size_t i = 0; i < samples; ++i) {
        trace.push_back(run.sampled_m());
        swing_m = std::max(swing_m, std::abs(run.position_m()));
        run.step();
        if (swing_m > kGrown) break;
        if ((i + 1) % window != 0) continue;
        if (swing_m < least_m) break;
        swing_m = 0;
    }
    return trace;
}

// How much the second half is smaller than the first, whatever is in the trace.
double envelope_per_sample(std::span<const double> trace) {
    const std::size_t half = trace.size() / 2;
    double first = 0, second = 0;
    for (std::size_t i = 0; i < half; ++i) {
        first += std::abs(trace[i]);
        second += std::abs(trace[half + i]);
    }
    return first > 0 && second > 0 ? portable::pow(second / first, 1 / static_cast<double>(half)) : 1;
}

// None where no oscillation can be measured.
std::optional<double> prony_per_sample(std::span<const double> trace) {
    const ZeroCrossings z = zero_crossings(trace);
    if (z.count < 3) return std::nullopt;
    const double half_period = static_cast<double>(z.last - z.first) / static_cast<double>(z.count - 1);
    const auto stride = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(half_period / 2)));
    if (trace.size() <= 2 * stride) return std::nullopt;
    double pp = 0, pq = 0, qq = 0, rp = 0, rq = 0;
    for (std::size_t n = 0; n + 2 * stride < trace.size(); ++n) {
        const double q = trace[n], p = trace[n + stride], r = trace[n + 2 * stride];
        pp += p * p;
        pq += p * q;
        qq += q * q;
        rp += r * p;
        rq += r * q;
    }
    const double determinant = pp * qq - pq * pq;
    if (!(determinant > 0)) return std::nullopt;
    const double a = (rp * qq - rq * pq) / determinant, b = (rq * pp - rp * pq) / determinant;
    const double discriminant = a * a / 4 + b;
    const double size = discriminant < 0 ? std::sqrt(-b) : std::abs(a) / 2 + std::sqrt(discriminant);
    return portable::pow(size, 1 / static_cast<double>(stride));
}

}  // namespace

double growth_per_sample(std::span<const double> trace) {
    constexpr double kMeant = 3;  // of the logarithm: a swing is not in step with the halves
    const double envelope = envelope_per_sample(trace);
    const std::optional<double> prony = prony_per_sample(trace);
    if (!prony) return envelope;
    const double apart = portable::log(*prony / envelope) * static_cast<double>(trace.size()) / 2;
    return std::abs(apart) < kMeant ? *prony : envelope;
}

// Of the second half, where the other modes have died out.
double measured_growth_per_s(const SampledLoop& loop, double encoder_step_m) {
    LoopConditions conditions;
    conditions.loop = loop;
    conditions.encoder_step_m = encoder_step_m;
    const std::vector<double> trace = linear_run(conditions);
    const std::span<const double> all(trace);
    return portable::log(growth_per_sample(all.subspan(all.size() / 2))) / loop.step_s;
}

MeasuredStiffness measured_critical_stiffness(const SampledLoop& loop, double encoder_step_m,
                                              double relative) {
    MeasuredStiffness measured;
    const auto grows_with = [&](double stiffness) {
        ++measured.runs;
        return measured_growth_per_s({loop.hand, stiffness, loop.delay_s, loop.step_s}, encoder_step_m) > 0;
    };
    constexpr int kMost = 60;
    double low = std::max(1e-3, loop.hand.damping_Ns_per_m / (loop.delay_s + loop.step_s)), high = low;
    for (int i = 0; i < kMost && grows_with(low); ++i) low /= 2;
    for (int i = 0; i < kMost && !grows_with(high); ++i) high *= 2;
    while (high / low - 1 > relative) {
        const double middle = std::sqrt(low * high);
        (grows_with(middle) ? high : low) = middle;
    }
    measured.stiffness_N_per_m = std::sqrt(low * high);
    return measured;
}

double measured_critical_delay_s(const HeldMass& hand, double stiffness_N_per_m) {
    constexpr double kStep_s = 1e-4;
    double stable_s = 0, unstable_s = 0.02;
    while (unstable_s - stable_s > 1e-7) {
        const double middle_s = (stable_s + unstable_s) / 2;
        const bool grows = measured_growth_per_s({hand, stiffness_N_per_m, middle_s, kStep_s}, 0) > 0;
        (grows ? unstable_s : stable_s) = middle_s;
    }
    return (stable_s + unstable_s) / 2 + kStep_s / 2;
}

HoldWatch::HoldWatch(const HoldPlan& plan, double step_s)
    : position_scale_(plan.position_scale),
      samples_(static_cast<long>(plan.duration_s / step_s)),
      watched_(static_cast<long>(kWatched_s / step_s)) {}

void HoldWatch::add(double sampled_before_m, double sampled_m, double position_m, double energy_J) {
    const long from = samples_ - watched_;
    if (done_++ < from) return;
    if (done_ - 1 == from) {
        low_m_ = high_m_ = position_m;
        energy_before_J_ = energy_J;
    }
    low_m_ = std::min(low_m_, position_m);
    high_m_ = std::max(high_m_, position_m);
    energy_J_ = energy_J;
    touches_ = sampled_m > 0;
    if (sampled_before_m > 0 && !touches_) ++losses_;
}

HoldOutcome HoldWatch::outcome() const {
    constexpr double kSettled_m = 1e-4, kOscillates_m = 1e-3, kGrowth_J = 0.01;
    HoldOutcome outcome;
    outcome.peak_to_peak_m = high_m_ - low_m_;
    outcome.losses_per_s = static_cast<double>(losses_) / kWatched_s;
    outcome.energy_J = energy_J_;
    outcome.energy_grows = energy_J_ - energy_before_J_ < -kGrowth_J;
    const double needle_m = position_scale_ * outcome.peak_to_peak_m;
    if (losses_ == 0 && touches_ && needle_m <= kSettled_m) outcome.label = HoldClass::kSettles;
    if (outcome.losses_per_s >= 1 || needle_m >= kOscillates_m) outcome.label = HoldClass::kOscillates;
    return outcome;
}

HoldOutcome measured_hold(const LoopConditions& conditions, const HoldPlan& plan) {
    LoopSimulator run(conditions, plan.start_m, plan.start_m_per_s);
    return watched_hold(run, plan, conditions.loop.step_s);
}

}  // namespace thimble
