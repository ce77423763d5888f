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
        const bool must_hold = condition.modality != Modality::kHF || same_delay(condition.delay_s, 0);
        if (must_hold && condition.oscillating > 0) reasons.push_back(describe(condition, ""));
        const bool must_oscillate = !must_hold && same_delay(condition.delay_s, delay_s);
        if (must_oscillate && condition.judged > 0 && 2 * condition.oscillating <= condition.judged) {
            reasons.push_back(describe(condition, "only "));
        }
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
