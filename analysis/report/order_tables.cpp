#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "analysis/findings.hpp"
#include "analysis/report/report_tables.hpp"
#include "analysis/statistics/mixed_model.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

constexpr double kTrialsPerStep = 10;

struct OrderData {
    NamedValues values;
    std::vector<NamedValues> columns;
    std::vector<std::size_t> subject;
};

OrderData order_data(const StudyColumns& columns, Metric metric) {
    OrderData data;  // filled in steps: in one nested initializer, g++ 12 frees twice where no memory is left
    data.values.name = info(metric).name;
    for (const char* column : {"intercept", "per ten trials"}) data.columns.push_back({column, {}});
    std::vector<StudyColumns::Condition> there;
    for (const StudyColumns::Condition& condition : columns.conditions())
        if (!columns.rows_of(condition).empty()) there.push_back(condition);
    for (std::size_t c = 1; c < there.size(); ++c)
        data.columns.push_back({fmt::format("{} - {}", there[c].name, there[0].name), {}});
    for (std::size_t c = 0; c < there.size(); ++c) {
        for (const TrialRow& row : columns.rows_of(there[c])) {
            const double value = info(metric).value(row.metrics);
            if (std::isnan(value)) continue;
            data.values.values.push_back(value);
            data.subject.push_back(row.conditions.subject);
            data.columns[0].values.push_back(1);
            data.columns[1].values.push_back(row.conditions.trial / kTrialsPerStep);
            for (std::size_t k = 2; k < data.columns.size(); ++k)
                data.columns[k].values.push_back(k - 1 == c ? 1 : 0);
        }
    }
    return data;
}

// Nothing where the trials are too few or all alike.
std::optional<MixedModel> model_of(const StudyColumns& columns, Metric metric) {
    const OrderData data = order_data(columns, metric);
    try {
        return mixed_model(data.values, data.columns, data.subject);
    } catch (const Error&) {
        return std::nullopt;
    }
}

void add_rows(ReportTable& table, const MixedModel& model, Metric metric) {
    for (std::size_t k = 1; k < model.effects.size(); ++k) {
        const FixedEffect& effect = model.effects[k];
        table.rows.push_back({std::string(info(metric).label), effect.name,
                              shown_text(effect.estimate, metric), shown_text(effect.interval.low, metric),
                              shown_text(effect.interval.high, metric), fmt::format("{:.2g}", effect.p)});
    }
    const std::string dash(kDash);
    table.rows.push_back({std::string(info(metric).label), "SD between subjects",
                          shown_text(std::sqrt(model.variance_group), metric), dash, dash, dash});
}

}  // namespace

std::vector<ReportTable> order_tables(const std::vector<TrialRow>& rows) {
    std::vector<ReportTable> tables;
    std::set<std::uint32_t> experiments;
    for (const TrialRow& row : rows) experiments.insert(row.conditions.experiment);
    for (const std::uint32_t experiment : experiments) {
        for (const double delay_s : delays_of(of_experiment(rows, experiment))) {
            const StudyColumns columns(rows, experiment, delay_s);
            ReportTable table{
                fmt::format("Single trials of experiment {} at {}", experiment, delay_text(delay_s)),
                "Linear mixed model (REML) with fixed effects of modality and trial number, and a random "
                "intercept per subject. From, to: 95 % Wald interval of this effect alone.",
                {"measure", "effect", "estimate", "from", "to", "P"}};
            for (const Metric metric : measures_of(experiment))
                if (const auto model = model_of(columns, metric)) add_rows(table, *model, metric);
            if (!table.rows.empty()) tables.push_back(std::move(table));
        }
    }
    return tables;
}

}  // namespace thimble
