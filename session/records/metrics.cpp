#include "session/records/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace thimble {
namespace {

using Samples = std::span<const TrajectorySample>;

struct Contact {
    double fixture_m;
    double penetration_m(const TrajectorySample& sample) const {
        return sample.position_needle_m - fixture_m;
    }
    bool operator()(const TrajectorySample& sample) const {
        return sample.fixture_present && penetration_m(sample) > 0;
    }
};

// First contact up to and including the beep. A fixture that is taken away ends the span as well: what lies
// behind it then is free space, not penetration.
Samples contact_span(const TrialRecord& record, const Contact& in_contact) {
    const Samples samples{record.samples};
    const auto begin = std::find_if(samples.begin(), samples.end(), in_contact);
    const auto end = std::find_if(begin, samples.end(), [&](const TrajectorySample& sample) {
        return sample.time_s > record.beep_time_s || !sample.fixture_present;  // never later than a NaN
    });
    return {begin, end};
}

void measure_penetration(Samples span, const Contact& in_contact, TrialMetrics& metrics) {
    double sum_m = 0;
    double max_m = 0;
    std::size_t n = 0;
    bool touching = false;
    for (const TrajectorySample& sample : span) {
        const bool touched = touching;
        touching = in_contact(sample);
        if (touched && !touching) ++metrics.contacts_lost;
        if (!touching) continue;
        sum_m += in_contact.penetration_m(sample);
        max_m = std::max(max_m, in_contact.penetration_m(sample));
        ++n;
    }
    if (n == 0) return;
    metrics.penetration_mean_m = sum_m / static_cast<double>(n);
    metrics.penetration_max_m = max_m;
}

// Relative to the first sample, so that a needle at rest has an rms of exactly zero.
double mean_needle_m(Samples hold) {
    const double origin_m = hold.front().position_needle_m;
    double sum_m = 0;
    for (const TrajectorySample& sample : hold) sum_m += sample.position_needle_m - origin_m;
    return origin_m + sum_m / static_cast<double>(hold.size());
}

// Upward crossings per second, between the first and the last of them. A crossing counts once the needle has
// been below the band around the mean and is above it.
double crossing_frequency_Hz(Samples hold, double mean_m, double band_m) {
    bool below = false;
    std::size_t crossings = 0;
    double first_s = 0;
    double last_s = 0;
    for (const TrajectorySample& sample : hold) {
        const double deviation_m = sample.position_needle_m - mean_m;
        if (deviation_m < -band_m) below = true;
        if (!below || deviation_m <= band_m) continue;
        below = false;
        if (crossings++ == 0) first_s = sample.time_s;
        last_s = sample.time_s;
    }
    if (crossings < 2 || !(last_s > first_s)) return TrialMetrics::kNone;
    return static_cast<double>(crossings - 1) / (last_s - first_s);
}

void measure_oscillation(Samples span, TrialMetrics& metrics) {
    const auto begin = std::find_if(span.begin(), span.end(), [&](const TrajectorySample& sample) {
        return sample.time_s >= span.front().time_s + kHoldSettling_s;
    });
    const Samples hold{begin, span.end()};
    if (hold.empty()) return;
    const double mean_m = mean_needle_m(hold);
    double squares_m2 = 0;
    double low_m = hold.front().position_needle_m;
    double high_m = low_m;
    for (const TrajectorySample& sample : hold) {
        const double deviation_m = sample.position_needle_m - mean_m;
        squares_m2 += deviation_m * deviation_m;
        low_m = std::min(low_m, sample.position_needle_m);
        high_m = std::max(high_m, sample.position_needle_m);
    }
    metrics.oscillation_rms_m = std::sqrt(squares_m2 / static_cast<double>(hold.size()));
    metrics.oscillation_peak_to_peak_m = high_m - low_m;
    // Half the rms keeps ripples on a large oscillation from being counted.
    const double band_m = std::max(kCrossingHysteresis_m, 0.5 * metrics.oscillation_rms_m);
    metrics.oscillation_frequency_Hz = crossing_frequency_Hz(hold, mean_m, band_m);
}

double peak_displacement_m(Samples samples, const Contact& in_contact) {
    const auto removal = std::adjacent_find(
        samples.begin(), samples.end(), [](const TrajectorySample& before, const TrajectorySample& after) {
            return before.fixture_present && !after.fixture_present;
        });
    if (removal == samples.end()) return TrialMetrics::kNone;
    const auto first_without = removal + 1;
    double sum_m = 0;
    std::size_t n = 0;
    for (auto sample = samples.begin(); sample != first_without; ++sample) {
        if (sample->time_s < first_without->time_s - kBeforeRemoval_s) continue;
        sum_m += in_contact.penetration_m(*sample);
        ++n;
    }
    if (n == 0) return TrialMetrics::kNone;  // a gap of more than 5 s before the removal
    double peak_m = in_contact.penetration_m(*first_without);
    for (auto sample = first_without; sample != samples.end(); ++sample) {
        peak_m = std::max(peak_m, in_contact.penetration_m(*sample));
    }
    return peak_m - sum_m / static_cast<double>(n);
}

}  // namespace

TrialMetrics measure(const TrialRecord& record) {
    TrialMetrics metrics;
    metrics.beeped = std::isfinite(record.beep_time_s);
    if (!record.samples.empty()) metrics.duration_s = record.samples.back().time_s;
    const Contact in_contact{record.conditions.fixture_position_m};

    const auto puncture =
        std::find_if(record.samples.begin(), record.samples.end(),
                     [](const TrajectorySample& sample) { return sample.phase == TissuePhase::kPenetrated; });
    if (puncture != record.samples.end()) {
        metrics.puncture_time_s = puncture->time_s;
        if (metrics.beeped) metrics.completion_time_s = record.beep_time_s - puncture->time_s;
    }
    metrics.peak_displacement_m = peak_displacement_m(record.samples, in_contact);

    const Samples span = contact_span(record, in_contact);
    if (span.empty()) return metrics;
    metrics.first_contact_time_s = span.front().time_s;
    measure_penetration(span, in_contact, metrics);
    measure_oscillation(span, metrics);
    metrics.oscillates =
        metrics.contacts_lost >= kOscillationContactsLost && metrics.oscillation_rms_m > kOscillationRms_m;
    return metrics;
}

}  // namespace thimble
