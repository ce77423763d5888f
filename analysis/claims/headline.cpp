#include "analysis/claims/headline.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace thimble {
namespace {

std::string describe(const ConditionSummary& condition, std::string_view how) {
    return fmt::format("{} oscillates in {}{} of {} trials at {}", to_string(condition.modality), how,
                       condition.oscillating, condition.judged, delay_text(condition.delay_s));
}

std::vector<std::string> objections(const std::vector<ConditionSummary>& conditions, double delay_s) {
    std::vector<std::string> reasons;
    for (const ConditionSummary& condition : conditions) {
        const bool delayed = !same_delay(condition.delay_s, 0), handle = condition.modality == Modality::kHF;
        if (condition.judged == 0 || (handle && delayed && !same_delay(condition.delay_s, delay_s))) continue;
        if (oscillates_as_claimed(condition.modality, delayed, condition.judged, condition.oscillating))
            continue;
        reasons.push_back(describe(condition, handle && delayed ? "only " : ""));
    }
    return reasons;
}

std::vector<std::string> gaps(const std::vector<ConditionSummary>& conditions, double delay_s) {
    std::vector<std::string> reasons;
    for (const double at_s : {0.0, delay_s}) {
        std::string missing;
        for (const Modality modality : kModalities) {
            const auto condition = find_condition(conditions, modality, at_s);
            const bool judged = condition != conditions.end() && condition->judged > 0;
            if (!judged) missing += (missing.empty() ? "" : ", ") + std::string(to_string(modality));
        }
        if (missing.empty()) continue;
        reasons.push_back(fmt::format("no trial of {} at {} that can be judged", missing, delay_text(at_s)));
    }
    return reasons;
}

}  // namespace

const char* to_string(Verdict verdict) {
    switch (verdict) {
        case Verdict::kSupported:
            return "supported";
        case Verdict::kNotSupported:
            return "not supported";
        case Verdict::kNotJudged:
            break;
    }
    return "not judged";
}

bool oscillates_as_claimed(Modality modality, bool delayed, std::uint32_t trials, std::uint32_t oscillating) {
    return modality == Modality::kHF && delayed ? 2 * oscillating > trials : oscillating == 0;
}

OscillationCount count_oscillations(const std::vector<TrialRow>& rows, Modality modality) {
    OscillationCount count;
    for (const TrialRow& row : rows) {
        if (row.conditions.modality != modality) continue;
        ++count.trials;
        count.subjects.insert(row.conditions.subject);
        if (!row.metrics.oscillates) continue;
        ++count.oscillating;
        count.unstable.insert(row.conditions.subject);
    }
    return count;
}

std::string Headline::claim() const { return fmt::format("At {} only HF oscillates", delay_text(delay_s)); }

std::string Headline::sentence() const {
    const std::string why = reasons.empty() ? "" : fmt::format(" ({})", fmt::join(reasons, "; "));
    return fmt::format("{}: {}{}.", claim(), to_string(verdict), why);
}

Headline judge_headline(const std::vector<ConditionSummary>& conditions, double delay_s) {
    Headline headline{delay_s, Verdict::kNotSupported, objections(conditions, delay_s)};
    if (!headline.reasons.empty()) return headline;
    headline.reasons = gaps(conditions, delay_s);
    headline.verdict = headline.reasons.empty() ? Verdict::kSupported : Verdict::kNotJudged;
    return headline;
}

}  // namespace thimble
