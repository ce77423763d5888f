// The trials of each subject, and their order. Everything is drawn from streams keyed by study, experiment, subject
// and trial, so that adding a subject or a trial changes no other.
#pragma once

#include <cstdint>
#include <vector>

#include "session/records/trial_record.hpp"
#include "session/settings/system_settings.hpp"

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
    TrialOrder order = TrialOrder::kShuffled;
    // Experiment 2: instead, each subject does this many trials at whose beep the fixture vanishes, each with
    // another modality; over as many subjects as there are modalities every modality comes equally often.
    std::uint32_t removals_per_subject = 0;
};

inline constexpr std::uint32_t kSubjectsWithoutDelay = 16;  // of experiments 1 and 2: the same people
inline constexpr std::uint32_t kSubjectsWithDelay = 10;     // of experiment 3
inline constexpr std::uint32_t kRemovals = 2;               // of experiment 2, per subject

// The paper's experiments. 1: no delay, 6 trials per modality. 2: two further trials of each subject of
// experiment 1, with the fixture's sudden removal. 3: as 1, with 50 ms on the force path.
Protocol experiment_1(const SystemSettings& settings, std::uint32_t subjects, std::uint64_t seed);
Protocol experiment_2(const SystemSettings& settings, std::uint32_t subjects, std::uint64_t seed);
Protocol experiment_3(const SystemSettings& settings, std::uint32_t subjects, std::uint64_t seed);

// The trials that a session file plans: each experiment of [protocol], at each delay. Without [protocol] as by an empty one.
std::vector<Protocol> session_protocols(const SystemSettings& settings);
// The trials are those of the paper, whatever the subjects, their number, the order and the fixtures. Tables of trials:
// are_paper_trials(); session files: is_paper_session().
bool plans_paper_trials(const Protocol& protocol);

// Uniform within +-jitter around the nominal position.
double draw_fixture_position_m(const Protocol& protocol, std::uint32_t subject, std::uint32_t trial);

// Sequences of 0 .. conditions - 1, each a row: `conditions` of them if that is even, else twice as many.
std::vector<std::vector<std::uint32_t>> williams_design(std::uint32_t conditions);

// One subject's trials, in order.
std::vector<TrialConditions> subject_trials(const Protocol& protocol, std::uint32_t subject);
// The same with the removal trials of the same people (`further`, experiment 2 after 1) where they are done:
// one after the first half of a subject's trials, one after the second, and so on. `further` may be null.
std::vector<TrialConditions> participant_trials(const Protocol& protocol, const Protocol* further,
                                                std::uint32_t subject);
// Subject after subject. The removal trials of the same people (experiment 2 after 1) stand in their participant sessions.
std::vector<TrialConditions> all_trials(const std::vector<Protocol>& protocols);

}  // namespace thimble
