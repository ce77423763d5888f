#include <algorithm>
#include <cmath>

#include "common/math/portable.hpp"
#include "study/fit/emulator.hpp"

namespace thimble {
namespace {

// Least movement, so that its logarithm exists: a third of an encoder step.
constexpr double kLeast_m = 1e-5;
constexpr double kLeast_s = 1e-3;
constexpr double kSpeedSpan_s = 2, kSettling_s = 1, kTremble_s = 0.05, kVelocitySpan_s = 0.02;
constexpr double kLeavingSpeed_m_per_s = 0.01;

double log_of_length(double length_m) { return portable::log(std::max(length_m, kLeast_m)); }
double log_of_time(double time_s) { return portable::log(std::max(time_s, kLeast_s)); }

class Course {
  public:
    Course(std::span<const TrajectorySample> samples, double fixture_position_m, double beep_time_s)
        : samples_(samples), fixture_m_(fixture_position_m), beep_s_(beep_time_s) {}

    std::optional<TrialFeatures> features() {
        if (!find_instants()) return std::nullopt;
        const double speed_span_s = std::min(kSpeedSpan_s, 0.6 * (contact_s_ - touch_s_));
        const double speed_m_per_s = (at(contact_s_) - at(contact_s_ - speed_span_s)) / speed_span_s;
        const double slow_s = first_slower(0.5 * (velocity(touch_s_) + speed_m_per_s));
        const double leave_s = first_leaving();
        if (!(speed_m_per_s > 0) || std::isnan(slow_s) || std::isnan(leave_s)) return std::nullopt;
        measure_hold();
        return TrialFeatures{
            portable::log(speed_m_per_s),  log_of_time(slow_s - touch_s_),
            log_of_length(depth_m_),       log_of_time(first_at_depth(0.9 * depth_m_) - contact_s_),
            log_of_length(wander_m_),      log_of_length(tremble_m_),
            log_of_time(leave_s - beep_s_)};
    }

  private:
    bool find_instants() {
        for (const TrajectorySample& s : samples_) {
            if (std::isnan(touch_s_) && s.phase != TissuePhase::kFree) touch_s_ = s.time_s;
            if (s.position_needle_m <= fixture_m_) continue;
            contact_s_ = s.time_s;
            break;
        }
        return contact_s_ - touch_s_ > 0.2 && beep_s_ > contact_s_ + kSettling_s + 0.5 &&
               samples_.back().time_s > beep_s_;
    }

    // Index of the first sample that is not before `time_s`.
    std::size_t index(double time_s) const {
        const auto found = std::lower_bound(samples_.begin(), samples_.end(), time_s,
                                            [](const TrajectorySample& s, double t) { return s.time_s < t; });
        return std::min(static_cast<std::size_t>(found - samples_.begin()), samples_.size() - 1);
    }
    double at(double time_s) const { return samples_[index(time_s)].position_needle_m; }
    double velocity(double time_s) const {
        return (at(time_s) - at(time_s - kVelocitySpan_s)) / kVelocitySpan_s;
    }

    double first_slower(double speed_m_per_s) const {
        for (std::size_t i = index(touch_s_); i < index(contact_s_); ++i)
            if (velocity(samples_[i].time_s) < speed_m_per_s) return samples_[i].time_s;
        return std::nan("");
    }
    double first_leaving() const {
        for (std::size_t i = index(beep_s_); i < samples_.size(); ++i)
            if (velocity(samples_[i].time_s) < -kLeavingSpeed_m_per_s) return samples_[i].time_s;
        return std::nan("");
    }
    double first_at_depth(double depth_m) const {
        std::size_t i = index(contact_s_);
        while (i + 1 < samples_.size() && samples_[i].position_needle_m - fixture_m_ < depth_m) ++i;
        return samples_[i].time_s;
    }

    void measure_hold() {
        const std::size_t begin = index(contact_s_ + kSettling_s), end = index(beep_s_);
        const auto n = static_cast<double>(end - begin);
        for (std::size_t i = begin; i < end; ++i)
            depth_m_ += (samples_[i].position_needle_m - fixture_m_) / n;
        const std::size_t lag = begin - index(samples_[begin].time_s - kTremble_s);
        for (std::size_t i = begin; i < end; ++i) {
            const double away_m = samples_[i].position_needle_m - fixture_m_ - depth_m_;
            const double moved_m = samples_[i].position_needle_m - samples_[i - lag].position_needle_m;
            wander_m_ += away_m * away_m / n;
            tremble_m_ += moved_m * moved_m / n;
        }
        wander_m_ = std::sqrt(wander_m_);
        tremble_m_ = std::sqrt(tremble_m_);
    }

    std::span<const TrajectorySample> samples_;
    double fixture_m_, beep_s_;
    double touch_s_ = std::nan(""), contact_s_ = std::nan("");
    double depth_m_ = 0, wander_m_ = 0, tremble_m_ = 0;
};

}  // namespace

std::optional<TrialFeatures> trial_features(std::span<const TrajectorySample> samples,
                                            double fixture_position_m, double beep_time_s) {
    if (samples.empty() || std::isnan(beep_time_s)) return std::nullopt;
    return Course(samples, fixture_position_m, beep_time_s).features();
}

}  // namespace thimble
