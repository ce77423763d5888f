// The claim everything is built around (E3.stable): with a 50 ms delay only HF oscillates; VF, CF and CCF
// hold a stable contact; and without delay nobody oscillates.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "session/records/condition_summary.hpp"

namespace thimble {

inline constexpr double kHeadlineDelay_s = 0.05;

enum class Verdict : std::uint8_t { kSupported, kNotSupported, kNotJudged };
const char* to_string(Verdict verdict);

struct Headline {
    double delay_s = kHeadlineDelay_s;
    Verdict verdict = Verdict::kNotJudged;
    std::vector<std::string> reasons;  // empty if supported

    std::string claim() const;     // "At 50 ms only HF oscillates"
    std::string sentence() const;  // claim, verdict and reasons
};

// The claim for one modality. With the delay HF oscillates in more than half of its trials. Without it, and in any
// other modality, no trial does.
bool oscillates_as_claimed(Modality modality, bool delayed, std::uint32_t trials, std::uint32_t oscillating);

struct OscillationCount {
    std::uint32_t trials = 0, oscillating = 0;
    std::set<std::uint32_t> subjects, unstable;  // with a trial; with one that oscillates
};
OscillationCount count_oscillations(const std::vector<TrialRow>& rows, Modality modality);

// Not supported: another modality than HF oscillates in any trial; HF oscillates in any trial without delay;
// HF oscillates in no more than half of its trials at `delay_s`. Not judged: nothing speaks against it, but a
// modality has no judged trial without delay or at `delay_s`.
Headline judge_headline(const std::vector<ConditionSummary>& conditions, double delay_s = kHeadlineDelay_s);

}  // namespace thimble
