// Who does which trials in which order. Everything is drawn from streams keyed by study, experiment, subject
// and trial, so that adding a subject or a trial changes no other.
#pragma once

#include <cstdint>
#include <vector>

#include "experiment/system_settings.hpp"
#include "experiment/trial_record.hpp"

namespace thimble {

struct Protocol {
    std::uint32_t experiment = 3;
    std::uint32_t subjects = 10;
    std::uint32_t trials_per_modality = 6;
    std::vector<Modality> modalities{kModalities.begin(), kModalities.end()};
    double delay_s = 0.05;
    std::uint64_t seed = 1;
    double fixture_position_m = 0.123;
    double fixture_jitter_m = 0.015;
};

// Experiment 3 of the paper: 10 subjects x 24 trials, 6 of each modality in random order, 50 ms on the force
// path.
Protocol experiment_3(const SystemSettings& settings, std::uint32_t subjects, std::uint64_t seed);

// Uniform within +-jitter around the nominal position.
double draw_fixture_position_m(const Protocol& protocol, std::uint32_t subject, std::uint32_t trial);

// One subject's trials, in order (shuffled: Fisher-Yates).
std::vector<TrialConditions> subject_trials(const Protocol& protocol, std::uint32_t subject);
// Subject after subject.
std::vector<TrialConditions> all_trials(const Protocol& protocol);

}  // namespace thimble
