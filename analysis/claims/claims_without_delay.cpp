// Experiments 1 and 2: no delay.
#include <fmt/format.h>

#include "analysis/claims/claim_list.hpp"
#include "analysis/statistics/anova.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/friedman.hpp"
#include "analysis/statistics/normality.hpp"
#include "analysis/statistics/pairwise.hpp"

namespace thimble {
namespace {

// Columns HF, CF, CCF, VF ascend.
bool in_order(const SampleTable& table) {
    for (std::size_t i = 1; i < table.conditions(); ++i) {
        if (sample_mean(table.column(i - 1)) >= sample_mean(table.column(i))) return false;
    }
    return true;
}

Finding order_finding(const StudyColumns& columns, Metric metric) {
    const SampleTable table = columns.table(metric).table;
    const RepeatedAnova anova = repeated_anova(table);
    return {fmt::format("{}; F({:g}, {:g}) = {:.1f}, {}, Greenhouse-Geisser {}, partial eta^2 = {:.2f}",
                        means_text(table, metric), anova.df_conditions, anova.df_error, anova.f,
                        p_text(anova.p), p_text(anova.p_greenhouse_geisser), anova.partial_eta_squared),
            in_order(table) && anova.p < kHighlySignificant, in_order(table)};
}

// All six pairs in the paper's direction, each at its limit.
Finding pairs_finding(const StudyColumns& columns, Metric metric, double limit_cf_ccf) {
    const SampleTable table = columns.table(metric).table;
    bool all = true;
    bool ascending = true;
    std::string text;
    for (const MeanPair& pair : pairs_after_repeated_anova(table)) {
        const bool cf_ccf = table.name(pair.first) == "CF" && table.name(pair.second) == "CCF";
        ascending = ascending && pair.difference < 0;
        all = all && ascending && pair.p_bonferroni < (cf_ccf ? limit_cf_ccf : 1e-3);
        text += fmt::format("{}{} - {} {}", text.empty() ? "" : ", ", table.name(pair.first),
                            table.name(pair.second), p_text(pair.p_bonferroni));
    }
    return {text, all, ascending};
}

// The paper chose its tests by this: those of penetration are parametric, that of time is not.
Finding normality_finding(const StudyColumns& columns) {
    constexpr double kLevel = 0.05;
    const auto failing = [&](Metric metric) {
        const SampleTable table = columns.table(metric).table;
        std::string names;
        for (std::size_t i = 0; i < table.conditions(); ++i) {
            const Normality test = normality(table.column(i));
            if (test.p < kLevel) names += fmt::format(" {} ({})", table.name(i), p_text(test.p));
        }
        return names;
    };
    const std::string mean = failing(Metric::kPenetrationMean);
    const std::string max = failing(Metric::kPenetrationMax);
    const std::string time = failing(Metric::kCompletionTime);
    const auto words = [](const std::string& names) { return names.empty() ? " none" : names; };
    return {fmt::format("not normal at .05: mean penetration{}; maximum penetration{}; time{}", words(mean),
                        words(max), words(time)),
            mean.empty() && max.empty() && !time.empty()};
}

std::string group_means(const std::vector<NamedValues>& groups) {
    std::string text;
    for (const NamedValues& group : groups) {
        text += fmt::format("{}{} {:.2f}", text.empty() ? "" : ", ", group.name, 1e3 * sample_mean(group));
    }
    return text + " mm";
}

// The pairs with HF in them, or those without it: text, and whether `good` holds for all.
template <class Good>
Finding removal_pairs(const StudyColumns& columns, bool with_handle, const Good& good) {
    const auto groups = columns.groups(Metric::kPeakDisplacement);
    Finding finding{"", true, {}};
    if (with_handle) finding.direction = true;
    for (const MeanPair& pair : pairs_after_one_way_anova(groups)) {
        if ((pair.first == 0) != with_handle) continue;
        finding.reproduced = finding.reproduced && good(pair);
        if (with_handle) finding.direction = *finding.direction && pair.difference > 0;
        finding.ours += fmt::format("{}{} - {} {}", finding.ours.empty() ? "" : ", ", groups[pair.first].name,
                                    groups[pair.second].name, p_text(pair.p_bonferroni));
    }
    return finding;
}

}  // namespace

void claim_without_delay(const StudyColumns& one, std::vector<Claim>& claims) {
    const auto mean = Metric::kPenetrationMean;
    const auto max = Metric::kPenetrationMax;
    add_claim(claims, one,
              {"E1.mean.order",
               "mean penetration HF < CF < CCF < VF",
               "RM-ANOVA F(3, 45) = 106.5, P < .0001",
               "",
               {},
               {}},
              [&] { return order_finding(one, mean); });
    add_claim(
        claims, one,
        {"E1.mean.pairs", "mean penetration: all six pairs differ", "Bonferroni, P < .001 each", "", {}, {}},
        [&] { return pairs_finding(one, mean, 1e-3); });
    add_claim(claims, one,
              {"E1.max.order",
               "maximum penetration HF < CF < CCF < VF",
               "RM-ANOVA F(3, 45) = 81.89, P < .0001",
               "",
               {},
               {}},
              [&] { return order_finding(one, max); });
    add_claim(claims, one,
              {"E1.max.pairs",
               "maximum penetration: all six pairs differ",
               "Bonferroni, CF - CCF P < .05, others P < .001",
               "",
               {},
               {}},
              [&] { return pairs_finding(one, max, 0.05); });
    add_claim(claims, one,
              {"E1.normal",
               "penetration columns pass the normality test, time columns do not",
               "D'Agostino-Pearson K2",
               "",
               {},
               {}},
              [&] { return normality_finding(one); });
    add_claim(claims, one,
              {"E1.time.same", "completion time does not differ", "Friedman, P > .1", "", {}, {}}, [&] {
                  const SampleTable table = one.table(Metric::kCompletionTime).table;
                  const Friedman test = friedman(table);
                  return Finding{fmt::format("{}; chi^2 = {:.2f}, {}, W = {:.2f}",
                                             means_text(table, Metric::kCompletionTime), test.chi_squared,
                                             p_text(test.p()), test.kendalls_w),
                                 test.p() > kNoDifference};
              });
}

void claim_sudden_removal(const StudyColumns& two, std::vector<Claim>& claims) {
    add_claim(claims, two,
              {"E2.peak.differs",
               "peak displacement differs",
               "one-way ANOVA F(3, 28) = 100.3, P < .0001",
               "",
               {},
               {}},
              [&] {
                  const auto groups = two.groups(Metric::kPeakDisplacement);
                  const OneWayAnova anova = one_way_anova(groups);
                  return Finding{fmt::format("{}; F({:g}, {:g}) = {:.1f}, {}", group_means(groups),
                                             anova.df_between, anova.df_within, anova.f, p_text(anova.p)),
                                 anova.p < kHighlySignificant};
              });
    add_claim(claims, two,
              {"E2.peak.hf",
               "HF's peak displacement is larger than each of the others'",
               "Bonferroni, P < .001 each",
               "",
               {},
               {}},
              [&] {
                  return removal_pairs(two, true, [](const MeanPair& pair) {
                      return pair.difference > 0 && pair.p_bonferroni < 1e-3;
                  });
              });
    add_claim(claims, two,
              {"E2.peak.rest",
               "VF, CF and CCF do not differ from each other",
               "Bonferroni, not significant",
               "",
               {},
               {}},
              [&] {
                  return removal_pairs(two, false,
                                       [](const MeanPair& pair) { return pair.p_bonferroni >= 0.05; });
              });
}

}  // namespace thimble
