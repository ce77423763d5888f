#include "analysis/statistics/anova.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/distributions.hpp"

namespace thimble {
namespace {

constexpr const char* kOneWay = "one-way ANOVA";
constexpr const char* kRepeated = "repeated-measures ANOVA";

void require_groups(const std::vector<NamedValues>& groups) {
    if (groups.size() < 2) {
        refuse(kOneWay, std::to_string(groups.size()) + " groups, needs at least 2; add a group");
    }
    for (const NamedValues& group : groups) {
        require_numbers(group, kOneWay);
        require_at_least(group, 1, kOneWay);
    }
}

// Sum of n_i (mean_i - grand mean)^2. Means as differences from the first: their own offset is then gone.
double spread_of_means(const std::vector<Moments>& groups, double n) {
    double grand = 0;
    for (const Moments& group : groups) {
        grand += static_cast<double>(group.n) * mean_difference(group, groups.front()) / n;
    }
    double spread = 0;
    for (const Moments& group : groups) {
        const double from_grand = mean_difference(group, groups.front()) - grand;
        spread += static_cast<double>(group.n) * from_grand * from_grand;
    }
    return spread;
}

// Every value taken apart: subject + condition + residual. Conditions and residuals add up to zero, subjects are
// counted from the first.
struct Parts {
    std::vector<double> subjects;
    std::vector<double> conditions;
    std::vector<double> residuals;  // row-major
    double largest = 0;             // magnitude of a cell
};

// Row means are taken off first, then the column means of what is left. Means of rows as differences from the
// first: the table's own offset is then gone.
Parts take_apart(const SampleTable& table) {
    const std::size_t k = table.conditions();
    Parts parts;
    const Moments first_row = moments(table.row(0));
    for (std::size_t s = 0; s < table.subjects(); ++s) {
        const Moments row = moments(table.row(s));
        parts.subjects.push_back(mean_difference(row, first_row));
        for (const double value : table.row(s)) parts.residuals.push_back(deviation(value, row));
        parts.largest = std::max(parts.largest, row.largest);
    }
    std::vector<double> column(table.subjects());
    for (std::size_t c = 0; c < k; ++c) {
        for (std::size_t s = 0; s < column.size(); ++s) column[s] = parts.residuals[s * k + c];
        const Moments of_column = moments(column);
        parts.conditions.push_back(of_column.mean);
        for (std::size_t s = 0; s < column.size(); ++s) {
            parts.residuals[s * k + c] = deviation(column[s], of_column);
        }
    }
    return parts;
}

double sum_of_squares(const std::vector<double>& values) { return moments(values).squares; }

// trace(S)^2 / ((k - 1) sum of S_ij^2) of the double-centred covariances S = R' R / (n - 1) of residuals R.
double greenhouse_geisser(const Parts& parts, double ss_error) {
    const std::size_t k = parts.conditions.size();
    const double scale = std::sqrt(ss_error);  // the trace becomes 1
    double squares = 0;
    for (std::size_t a = 0; a < k; ++a) {
        for (std::size_t b = 0; b < k; ++b) {
            double product = 0;
            for (std::size_t row = 0; row < parts.residuals.size(); row += k) {
                product += (parts.residuals[row + a] / scale) * (parts.residuals[row + b] / scale);
            }
            squares += product * product;
        }
    }
    const auto directions = static_cast<double>(k - 1);
    return std::clamp(1 / (directions * squares), 1 / directions, 1.0);
}

double huynh_feldt(double epsilon, double n, double directions) {
    const double above = n * directions * epsilon - 2;
    const double below = directions * (n - 1 - directions * epsilon);
    // Zero where n - 1 directions share the residuals equally: no departure that can be seen.
    if (!(below > 0)) return 1;
    return std::clamp(above / below, epsilon, 1.0);
}

}  // namespace

OneWayAnova one_way_anova(const std::vector<NamedValues>& groups) {
    require_groups(groups);
    OneWayAnova result;
    std::vector<Moments> parts;
    std::size_t n = 0;
    double largest = 0;
    for (const NamedValues& group : groups) {
        parts.push_back(moments(group.values));
        n += group.values.size();
        result.ss_within += parts.back().squares;
        largest = std::max(largest, parts.back().largest);
    }
    result.df_between = static_cast<double>(groups.size() - 1);
    result.df_within = static_cast<double>(n) - static_cast<double>(groups.size());
    if (!(result.df_within > 0)) refuse(kOneWay, "every group has a single value; measure more");
    if (at_rounding(result.ss_within, n, largest)) {
        refuse(kOneWay, "no group has any spread ('" + groups.front().name +
                            "' ... are constant); check where the values come from");
    }
    result.ss_between = spread_of_means(parts, static_cast<double>(n));
    result.f = result.ms_between() / result.ms_within();
    result.p = f_upper(result.f, result.df_between, result.df_within);
    result.eta_squared = result.ss_between / (result.ss_between + result.ss_within);
    return result;
}

RepeatedAnova repeated_anova(const SampleTable& table) {
    table.require_shape(3, 2, kRepeated);
    const Parts parts = take_apart(table);
    const auto n = static_cast<double>(table.subjects());
    const auto k = static_cast<double>(table.conditions());
    RepeatedAnova result;
    result.df_conditions = k - 1;
    result.df_error = (n - 1) * (k - 1);
    result.ss_conditions = n * sum_of_squares(parts.conditions);
    result.ss_subjects = k * sum_of_squares(parts.subjects);
    result.ss_error = sum_of_squares(parts.residuals);
    if (at_rounding(result.ss_error, table.cells().size(), parts.largest)) {
        refuse(kRepeated, "columns '" + table.name(0) +
                              "' ... differ by the same amount in every subject, so there is no error to "
                              "compare with; check where the values come from");
    }
    result.f = result.ms_conditions() / result.ms_error();
    result.p = f_upper(result.f, result.df_conditions, result.df_error);
    const auto corrected = [&](double epsilon) {
        return f_upper(result.f, epsilon * result.df_conditions, epsilon * result.df_error);
    };
    result.epsilon_greenhouse_geisser = greenhouse_geisser(parts, result.ss_error);
    result.epsilon_huynh_feldt = huynh_feldt(result.epsilon_greenhouse_geisser, n, k - 1);
    result.p_greenhouse_geisser = corrected(result.epsilon_greenhouse_geisser);
    result.p_huynh_feldt = corrected(result.epsilon_huynh_feldt);
    result.partial_eta_squared = result.ss_conditions / (result.ss_conditions + result.ss_error);
    result.generalised_eta_squared =
        result.ss_conditions / (result.ss_conditions + result.ss_subjects + result.ss_error);
    return result;
}

}  // namespace thimble
