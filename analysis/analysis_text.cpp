// Findings in words. Every word follows from a number: who is deeper, whether it is significant, whether the
// tests agree.
#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "analysis/analysis.hpp"
#include "analysis/claims/claim_findings.hpp"
#include "analysis/claims/headline.hpp"

namespace thimble {
namespace {

struct Words {
    std::string_view name;  // begins a sentence
    std::string_view unit;
    std::string_view verb, more, less;  // "HF was 3.9 mm shallower than CF"
};

Words words_of(Metric metric) {
    switch (metric) {
        case Metric::kPenetrationMean:
            return {"Mean penetration", "mm", "was", "deeper than", "shallower than"};
        case Metric::kPenetrationMax:
            return {"Maximum penetration", "mm", "was", "deeper than", "shallower than"};
        case Metric::kCompletionTime:
            return {"Completion time", "s", "was", "slower than", "faster than"};
        case Metric::kPeakDisplacement:
            return {"Peak displacement", "mm", "was displaced", "further than", "less far than"};
        default:
            return {info(metric).label, "", "was", "larger than", "smaller than"};
    }
}

class Narrator {
  public:
    Narrator(const MeasureAnalysis& measure, bool detailed)
        : m_(measure),
          words_(words_of(measure.metric)),
          full_(detailed && measure.kind == AnalysisKind::kFull) {}

    std::string tell() const {
        if (!m_.p()) return fmt::format("{} could not be tested{}", words_.name, problems(": "));
        std::string text = test_sentence() + normality_sentence() + pairs_sentence();
        if (full_) text += agreement_sentence();
        text += left_out_sentence();
        return text + (m_.problems.empty() ? "" : " Not computed" + problems(": "));
    }

    std::string tell_briefly() const { return m_.p() ? test_sentence() + told_apart_sentence() : tell(); }

  private:
    const std::string& name(std::size_t column) const { return m_.columns[column].values.name; }

    std::string shown(double value) const { return shown_text(value, m_.metric); }

    std::string interval(const ConfidenceInterval& of) const {
        return fmt::format("95 % CI {} to {} {}", shown(of.low), shown(of.high), words_.unit);
    }

    std::string problems(std::string_view before) const {
        std::string text;
        for (const std::string& problem : m_.problems) text += (text.empty() ? "" : "; ") + problem;
        return fmt::format("{}{}.", before, text.empty() ? "no test applies" : text);
    }

    // Ascending; equal means in the order of the modalities.
    std::string means() const {
        std::vector<const ColumnAnalysis*> order;
        for (const ColumnAnalysis& column : m_.columns) order.push_back(&column);
        std::stable_sort(order.begin(), order.end(), [](auto* a, auto* b) { return a->mean < b->mean; });
        std::string text;
        for (const ColumnAnalysis* column : order) {
            text +=
                fmt::format("{}{} {}", text.empty() ? "" : ", ", column->values.name, shown(column->mean));
        }
        return fmt::format("{} {}", text, words_.unit);
    }

    std::string eta_squared(std::string_view name, double value) const {
        std::string text = fmt::format("{} = {:.2f}", name, value);
        if (const auto& of = m_.eta_squared_interval)
            text += fmt::format(" (95 % CI {:.2f} to {:.2f})", of->low, of->high);
        return text;
    }

    std::string anova_text(const RepeatedAnova& anova) const {
        std::string text = fmt::format("F({:g}, {:g}) = {:.2f}, {}", anova.df_conditions, anova.df_error,
                                       anova.f, p_text(anova.p));
        if (!full_) return text;
        return text + fmt::format("; Greenhouse-Geisser epsilon = {:.2f}, {}; {}, generalised eta^2 = {:.2f}",
                                  anova.epsilon_greenhouse_geisser, p_text(anova.p_greenhouse_geisser),
                                  eta_squared("partial eta^2", anova.partial_eta_squared),
                                  anova.generalised_eta_squared);
    }

    std::string anova_text(const OneWayAnova& anova) const {
        std::string text = fmt::format("F({:g}, {:g}) = {:.2f}, {}", anova.df_between, anova.df_within,
                                       anova.f, p_text(anova.p));
        if (!full_) return text;
        return text + "; " + eta_squared("eta^2", anova.eta_squared);
    }

    std::string friedman_text(const Friedman& test) const {
        std::string text = fmt::format("chi^2({:g}) = {:.2f}, {}{}", test.df, test.chi_squared,
                                       test.p_exact ? "exact " : "asymptotic ", p_text(test.p()));
        if (!full_) return text;
        return text + fmt::format("; Kendall's W = {:.2f}", test.kendalls_w);
    }

    std::string chosen_text() const {
        if (m_.chosen == ChosenTest::kFriedman) return friedman_text(*m_.friedman);
        if (m_.chosen == ChosenTest::kOneWayAnova) return anova_text(*m_.one_way_anova);
        return anova_text(*m_.repeated_anova);
    }

    std::string test_sentence() const {
        return fmt::format("{} {} between modalities ({}, {}; {} {}): {}.", words_.name,
                           m_.differs() ? "differed" : "was not shown to differ", to_string(m_.chosen),
                           chosen_text(), m_.subjects, m_.within_subjects ? "subjects" : "trials", means());
    }

    std::string normality_sentence() const {
        std::string failing;
        bool judged = true;
        for (const ColumnAnalysis& column : m_.columns) {
            judged = judged && column.normality.has_value();
            if (!column.fails_normality()) continue;
            failing += fmt::format("{}{} ({})", failing.empty() ? "" : ", ", column.values.name,
                                   p_text(column.normality->p));
        }
        const bool ranks = m_.chosen == ChosenTest::kFriedman;
        if (!failing.empty()) {
            return fmt::format(" K2 rejects normality of {}: {}.", failing,
                               ranks ? "ranks decide" : "between groups the paper's rule knows ANOVA only");
        }
        if (!judged) {
            return fmt::format(" K2 cannot judge the normality of every column{}.",
                               ranks ? ": ranks decide" : "");
        }
        return fmt::format(" K2 rejects normality of no column{}.",
                           m_.within_subjects ? ": means decide" : "");
    }

    // First minus second, of means.
    double difference(const PairAnalysis& pair) const {
        return m_.columns[pair.first].mean - m_.columns[pair.second].mean;
    }

    // `sign` -1: of second minus first, where the sentence has already said who is larger.
    std::string detail(const PairAnalysis& pair, int sign) const {
        std::string text = p_text(*m_.p_of(pair));
        if (m_.chosen == ChosenTest::kFriedman) {
            const auto& ranks = m_.friedman->mean_ranks;
            text =
                fmt::format("mean ranks {:.2f} and {:.2f}, {}", ranks[pair.first], ranks[pair.second], text);
        }
        if (!full_) return text;
        if (const auto& of = m_.by_means(pair)) {
            const auto [low, high] = of->interval;
            text = interval(sign > 0 ? ConfidenceInterval{low, high} : ConfidenceInterval{-high, -low}) +
                   ", " + text;
        }
        if (pair.d_z) text += fmt::format(", d_z = {:.2f}", sign * pair.d_z->d_z);
        return text;
    }

    // By the ranks after Friedman's test, by the means after an analysis of variance. If the two disagree, the
    // sentence says so rather than giving a difference of the wrong sign.
    std::string pair_sentence(const PairAnalysis& pair) const {
        const double mean = difference(pair);
        if (m_.chosen == ChosenTest::kFriedman && pair.dunn->mean_rank_difference * mean < 0) {
            return fmt::format("{} ranked {} {}, although its mean is {} by {} {} ({})", name(pair.first),
                               mean < 0 ? "above" : "below", name(pair.second), mean < 0 ? "lower" : "higher",
                               shown(std::abs(mean)), words_.unit, detail(pair, mean < 0 ? -1 : 1));
        }
        return fmt::format("{} {} {} {} {} {} ({})", name(pair.first), words_.verb, shown(std::abs(mean)),
                           words_.unit, mean > 0 ? words_.more : words_.less, name(pair.second),
                           detail(pair, mean > 0 ? 1 : -1));
    }

    // The pairs that the comparison of the chosen test tells apart, or not.
    std::vector<const PairAnalysis*> pairs_told_apart(bool apart) const {
        std::vector<const PairAnalysis*> pairs;
        for (const PairAnalysis& pair : m_.pairs) {
            const auto p = m_.p_of(pair);
            if (p && (*p < kAnalysisLevel) == apart) pairs.push_back(&pair);
        }
        return pairs;
    }

    const char* comparison() const { return m_.chosen == ChosenTest::kFriedman ? "Dunn" : "Bonferroni"; }

    std::string told_apart_sentence() const {
        if (!m_.differs()) return "";
        std::string list;
        for (const PairAnalysis* pair : pairs_told_apart(true)) {
            list +=
                fmt::format("{}{} and {}", list.empty() ? "" : ", ", name(pair->first), name(pair->second));
        }
        return fmt::format(" Pairs that differ at {:g} ({}): {}.", kAnalysisLevel, comparison(),
                           list.empty() ? "none" : list);
    }

    std::string pairs_sentence() const {
        if (!m_.differs()) return widest_sentence();
        std::string apart;
        for (const PairAnalysis* pair : pairs_told_apart(true)) {
            apart += (apart.empty() ? " " : "; ") + pair_sentence(*pair);
        }
        if (apart.empty()) apart = " no pair differs by itself";
        std::string alike;
        for (const PairAnalysis* pair : pairs_told_apart(false)) {
            alike += fmt::format("{}{} - {} = {} {} ({})", alike.empty() ? "" : "; ", name(pair->first),
                                 name(pair->second), shown(difference(*pair)), words_.unit, detail(*pair, 1));
        }
        if (!alike.empty()) alike = " Not told apart: " + alike + ".";
        return fmt::format(" Pair by pair ({}):{}.{}", comparison(), apart, alike);
    }

    // The differences that "not shown to differ" leaves possible.
    std::string widest_sentence() const {
        if (!full_) return "";
        double widest = 0;
        for (const PairAnalysis& pair : m_.pairs) {
            const auto& of = m_.by_means(pair);
            if (!of) return "";
            widest = std::max({widest, std::abs(of->interval.low), std::abs(of->interval.high)});
        }
        return fmt::format(" The pairs' 95 % CIs leave room for differences up to {} {}.", shown(widest),
                           words_.unit);
    }

    std::string agreement_sentence() const {
        std::string text;
        const auto other = [&](std::string_view test, const std::string& numbers, double p) {
            const bool agrees = (p < kAnalysisLevel) == m_.differs();
            text += fmt::format(" {} {}: {}.", test, agrees ? "agrees" : "disagrees", numbers);
        };
        if (m_.chosen == ChosenTest::kRepeatedAnova && m_.friedman)
            other("Friedman's test", friedman_text(*m_.friedman), m_.friedman->p());
        if (m_.chosen == ChosenTest::kFriedman && m_.repeated_anova)
            other("ANOVA, corrected,", anova_text(*m_.repeated_anova),
                  m_.repeated_anova->p_greenhouse_geisser);
        if (m_.chosen == ChosenTest::kRepeatedAnova && m_.differs() &&
            m_.repeated_anova->p_greenhouse_geisser >= kAnalysisLevel) {
            text += " With Greenhouse and Geisser's correction it is not significant.";
        }
        return text + holm_sentence();
    }

    // Whether a less conservative correction, on the pairs' own differences where there are any, tells the same
    // pairs apart.
    std::string holm_sentence() const {
        if (!m_.differs()) return "";
        std::string disagreeing;
        for (const PairAnalysis& pair : m_.pairs) {
            const auto& by_means = m_.by_means(pair);
            const auto p = m_.p_of(pair);
            if (!by_means || !p) return "";
            if ((by_means->p_holm < kAnalysisLevel) == (*p < kAnalysisLevel)) continue;
            disagreeing += fmt::format("{}{} - {} ({})", disagreeing.empty() ? "" : ", ", name(pair.first),
                                       name(pair.second), p_text(by_means->p_holm));
        }
        return fmt::format(
            " {} with Holm's correction {}.", m_.within_subjects ? "Paired t tests" : "The same t tests",
            disagreeing.empty()
                ? fmt::format("agree on all {} pairs",
                              m_.pairs.size() == 6 ? std::string("six") : std::to_string(m_.pairs.size()))
                : "disagree on " + disagreeing);
    }

    std::string left_out_sentence() const {
        if (m_.left_out.empty()) return "";
        std::string list;
        for (const std::uint32_t subject : m_.left_out)
            list += fmt::format("{}{}", list.empty() ? "" : ", ", subject);
        return fmt::format(" Left out, for want of a value in some modality: subject {}.", list);
    }

    const MeasureAnalysis& m_;
    Words words_;
    bool full_;
};

}  // namespace

std::string finding_text(const MeasureAnalysis& measure) { return Narrator(measure, true).tell(); }

std::string finding_in_brief(const MeasureAnalysis& measure) {
    return Narrator(measure, false).tell_briefly();
}

std::string stability_text(const StudyColumns& columns) {
    std::string text;
    for (const Modality modality : kModalities) {
        const OscillationCount count = count_oscillations(columns.rows(), modality);
        text += fmt::format("{}{} {} of {} trials ({} of {} subjects)", text.empty() ? "" : ", ",
                            to_string(modality), count.oscillating, count.trials, count.unstable.size(),
                            count.subjects.size());
    }
    return fmt::format("Oscillation: {}.", text);
}

}  // namespace thimble
