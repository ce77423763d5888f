// How many subjects a study needs: a pool of virtual subjects does its trials once, and studies are drawn from the pool. Each is
// judged as a finding is (comparisons.hpp): signed ranks of the subjects' own differences, all pairs of a measure at once.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session/records/condition_summary.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

inline constexpr std::size_t kMostPowerSubjects = 100;

struct PowerOptions {
    std::vector<double> delays_s{0.05};
    double power = 0.9;                              // share of studies in which the comparison comes out
    std::optional<double> precision_m, precision_s;  // half the 95 % interval, instead of power
    std::uint32_t pool = 60;                         // virtual subjects
    std::uint32_t trials = 6;                        // of each subject and modality, at most
    std::uint32_t studies = 200;                     // drawn for each number of subjects
    std::uint64_t seed = 1;
    unsigned jobs = 0;
    const std::atomic<bool>* stop = nullptr;
};

struct PowerComparison {
    Metric metric = Metric::kPenetrationMean;
    std::string first, second;
    double delay_s = 0;
    double difference = 0;  // in the pool, SI: first minus second
    // By trials per modality: subjects needed; nothing if kMostPowerSubjects are not enough.
    std::map<std::uint32_t, std::optional<std::size_t>> subjects;
    std::vector<std::pair<std::size_t, double>> curve;  // subjects and power, with all trials
};

struct PowerResult {
    std::vector<PowerComparison> comparisons;
    bool complete = true;  // false: stopped
};

PowerResult plan_power(const SystemSettings& settings, const PowerOptions& options);

// "HF - CF, maximum penetration, 50 ms"
std::string name_of(const PowerComparison& comparison);

}  // namespace thimble
