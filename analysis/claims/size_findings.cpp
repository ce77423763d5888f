// Sizes of effects that the paper's tests imply, with the interval of what came out here.
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "analysis/claims/claim_findings.hpp"
#include "analysis/statistics/anova.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/distributions.hpp"

namespace thimble {
namespace {

constexpr double kConfidence = 0.95;

// Sum of the products of deviations over n - 1.
double covariance(const NamedValues& a, const NamedValues& b) {
    const double mean_a = sample_mean(a), mean_b = sample_mean(b);
    double sum = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) sum += (a.values[i] - mean_a) * (b.values[i] - mean_b);
    return sum / static_cast<double>(a.values.size() - 1);
}

NamedValues difference(const NamedValues& a, const NamedValues& b) {
    NamedValues result{a.name + " - " + b.name, {}};
    for (std::size_t i = 0; i < a.values.size(); ++i) result.values.push_back(a.values[i] - b.values[i]);
    return result;
}

// Of mean(a) / mean(b), whose values are paired; none where the denominator may be zero (Fieller 1954).
std::optional<ConfidenceInterval> ratio_interval(const NamedValues& a, const NamedValues& b) {
    const auto n = static_cast<double>(a.values.size());
    const double t = t_half_width(kConfidence, n - 1);
    const double mean_b = sample_mean(b), ratio = sample_mean(a) / mean_b;
    const double aa = covariance(a, a), ab = covariance(a, b), bb = covariance(b, b);
    const double g = t * t * bb / (n * mean_b * mean_b);
    if (g >= 1) return std::nullopt;
    const double centre = ratio - (bb > 0 ? g * ab / bb : 0);
    const double squares = aa - 2 * ratio * ab + ratio * ratio * bb - (bb > 0 ? g * (aa - ab * ab / bb) : 0);
    const double half = t / std::abs(mean_b) * std::sqrt(std::max(0.0, squares) / n);
    return ConfidenceInterval{(centre - half) / (1 - g), (centre + half) / (1 - g)};
}

std::string interval_text(const std::optional<ConfidenceInterval>& interval) {
    return interval ? fmt::format("95 % interval {:.3f} to {:.3f}", interval->low, interval->high)
                    : "no interval";
}

struct FTest {
    double f, df_1, df_2;
};

// F in 95 % of studies of the paper's size, if the true effect were the one that `here` estimates without bias. Noncentrality
// grows with the people of a condition.
ConfidenceInterval f_interval(const FTest& here, const FTest& paper, double more_people) {
    const double estimate = std::max(0.0, here.f * here.df_1 * (here.df_2 - 2) / here.df_2 - here.df_1);
    const double noncentrality = estimate / more_people;
    const double sum = paper.df_1 + noncentrality, tail = (1 - kConfidence) / 2;
    const double df = sum * sum / (sum + noncentrality);
    return {sum / paper.df_1 * f_quantile(tail, df, paper.df_2),
            sum / paper.df_1 * f_quantile(1 - tail, df, paper.df_2)};
}

// `more_people`: people of a condition here over those of the paper.
Finding f_finding(const FTest& here, const FTest& paper, double more_people) {
    const ConfidenceInterval interval = f_interval(here, paper, more_people);
    return {fmt::format("F({:g}, {:g}) = {:.1f}; 95 % of studies {}with this effect have {:.1f} to {:.1f}",
                        here.df_1, here.df_2, here.f, more_people == 1 ? "" : "of the paper's size ",
                        interval.low, interval.high),
            paper.f >= interval.low && paper.f <= interval.high};
}

}  // namespace

Finding f_size_finding(const StudyColumns& columns, Metric metric, double papers_f) {
    constexpr double kPeople = 16;
    const RepeatedAnova anova = repeated_anova(columns.table(metric).table);
    const double people = anova.df_error / anova.df_conditions + 1;
    return f_finding({anova.f, anova.df_conditions, anova.df_error}, {papers_f, 3, 3 * (kPeople - 1)},
                     people / kPeople);
}

Finding removal_f_finding(const StudyColumns& columns, double papers_f) {
    constexpr double kTrials = 8;  // of each modality, all of others
    const OneWayAnova anova = one_way_anova(columns.groups(Metric::kPeakDisplacement));
    const double trials = anova.df_within / (anova.df_between + 1) + 1;
    return f_finding({anova.f, anova.df_between, anova.df_within}, {papers_f, 3, 4 * (kTrials - 1)},
                     trials / kTrials);
}

Finding cost_ratio_finding(const StudyColumns& columns, Metric metric, double most) {
    const SampleTable table = columns.table(metric).table;  // HF, CF, CCF, VF
    const NamedValues cf = difference(table.column(1), table.column(0)),
                      vf = difference(table.column(3), table.column(0));
    const double ratio = sample_mean(cf) / sample_mean(vf);
    return {fmt::format("{:.2f} of {:.2f} mm: {:.3f}, {}", 1e3 * sample_mean(cf), 1e3 * sample_mean(vf),
                        ratio, interval_text(ratio_interval(cf, vf))),
            sample_mean(cf) > 0 && sample_mean(vf) > 0 && ratio <= most};
}

Finding removal_spread_finding(const StudyColumns& columns) {
    constexpr double kMost = 0.282;
    const auto groups = columns.groups(Metric::kPeakDisplacement);
    double others_m = 0;
    for (std::size_t i = 1; i < groups.size(); ++i)
        others_m += sample_mean(groups[i]) / static_cast<double>(groups.size() - 1);
    const double distance_m = sample_mean(groups[0]) - others_m, sd_m = sample_sd(groups[0]);
    const auto df = static_cast<double>(groups[0].values.size() - 1);
    const double ratio = sd_m / distance_m, tail = (1 - kConfidence) / 2;
    const ConfidenceInterval interval{ratio * std::sqrt(df / chi_squared_quantile(1 - tail, df)),
                                      ratio * std::sqrt(df / chi_squared_quantile(tail, df))};
    return {fmt::format("SD {:.2f} of {:.2f} mm: {:.3f}, {}", 1e3 * sd_m, 1e3 * distance_m, ratio,
                        interval_text(interval)),
            distance_m > 0 && ratio <= kMost};
}

}  // namespace thimble
