#include <fmt/format.h>

#include "analysis/analysis.hpp"

namespace thimble {
namespace {

using Row = std::vector<std::string>;

std::string range(const ConfidenceInterval& interval, Metric metric) {
    return fmt::format("{} to {}", shown_text(interval.low, metric), shown_text(interval.high, metric));
}

std::string range(const ConfidenceInterval& interval) {
    return fmt::format("{:.2f} to {:.2f}", interval.low, interval.high);
}

std::string p_cell(double p) { return p > 0 ? fmt::format("{:.2g}", p) : "<1e-300"; }

// `text` of an existing value, a dash for a refused one.
template <class Value, class Text>
std::string cell(const std::optional<Value>& value, const Text& text) {
    return value ? text(*value) : std::string(kDash);
}

// Statistic and P; where the analysis is full also correction, effect size and its interval. Dashes for a refused test.
struct TestCells {
    std::string statistic, p, correction, effect;
};

TestCells cells_of(const RepeatedAnova& a) {
    return {fmt::format("F({:g}, {:g}) = {:.2f}", a.df_conditions, a.df_error, a.f), p_cell(a.p),
            fmt::format("Greenhouse-Geisser: epsilon {:.2f}, P {}", a.epsilon_greenhouse_geisser,
                        p_cell(a.p_greenhouse_geisser)),
            fmt::format("partial eta^2 {:.2f}, generalised {:.2f}", a.partial_eta_squared,
                        a.generalised_eta_squared)};
}

TestCells cells_of(const Friedman& f) {
    return {fmt::format("chi^2({:g}) = {:.2f}", f.df, f.chi_squared), p_cell(f.p()),
            fmt::format("{}; asymptotic P {}", f.p_exact ? "exact" : "no exact P", p_cell(f.p_asymptotic)),
            fmt::format("Kendall's W {:.2f}", f.kendalls_w)};
}

TestCells cells_of(const OneWayAnova& a) {
    return {fmt::format("F({:g}, {:g}) = {:.2f}", a.df_between, a.df_within, a.f), p_cell(a.p),
            std::string(kDash), fmt::format("eta^2 {:.2f}", a.eta_squared)};
}

template <class Test>
void add_test(ReportTable& table, const MeasureAnalysis& m, ChosenTest kind,
              const std::optional<Test>& test) {
    const bool full = m.kind == AnalysisKind::kFull;
    if (!full && m.chosen != kind) return;
    const std::string dash(kDash);
    const TestCells cells = test ? cells_of(*test) : TestCells{dash, dash, dash, dash};
    Row row{std::string(info(m.metric).label),
            fmt::format("{}", m.subjects),
            m.chosen == kind ? "yes" : "",
            to_string(kind),
            cells.statistic,
            cells.p};
    if (full) {
        const bool has_interval = kind != ChosenTest::kFriedman && m.eta_squared_interval;
        row.insert(row.end(),
                   {cells.correction, cells.effect, has_interval ? range(*m.eta_squared_interval) : dash});
    }
    table.rows.push_back(std::move(row));
}

ReportTable test_table(const std::vector<MeasureAnalysis>& measures, bool full) {
    ReportTable table{
        "Tests",
        "The test that counts is chosen by normality (K2 at .05 on every column), as in the paper.",
        {"measure", "n", "counts", "test", "statistic", "P"}};
    if (full) {
        table.columns.insert(table.columns.end(), {"correction", "effect size", "95 % CI"});
        table.note += " The interval is that of (partial) eta^2; generalised eta^2 has none here.";
    }
    for (const MeasureAnalysis& m : measures) {
        if (m.columns.empty()) continue;
        if (m.within_subjects) {
            add_test(table, m, ChosenTest::kRepeatedAnova, m.repeated_anova);
            add_test(table, m, ChosenTest::kFriedman, m.friedman);
        } else {
            add_test(table, m, ChosenTest::kOneWayAnova, m.one_way_anova);
        }
    }
    return table;
}

ReportTable column_table(const std::vector<MeasureAnalysis>& measures) {
    ReportTable table{"Each modality",
                      "Over subjects, whose trials are averaged first; in experiment 2 over trials.",
                      {"measure", "modality", "n", "mean", "SD", "95 % CI of the mean", "median", "quartiles",
                       "K2", "P of K2"}};
    for (const MeasureAnalysis& m : measures) {
        for (const ColumnAnalysis& c : m.columns) {
            table.rows.push_back(
                {std::string(info(m.metric).label), c.values.name, fmt::format("{}", c.values.values.size()),
                 shown_text(c.mean, m.metric),
                 cell(c.sd, [&](double sd) { return shown_text(sd, m.metric); }),
                 cell(c.mean_interval, [&](const auto& interval) { return range(interval, m.metric); }),
                 shown_text(c.median, m.metric), range({c.lower_quartile, c.upper_quartile}, m.metric),
                 cell(c.normality, [](const Normality& n) { return fmt::format("{:.2f}", n.k2); }),
                 cell(c.normality, [](const Normality& n) { return p_cell(n.p); })});
        }
    }
    return table;
}

Row pair_row(const MeasureAnalysis& m, const PairAnalysis& pair, bool full) {
    const ColumnAnalysis& first = m.columns[pair.first];
    const ColumnAnalysis& second = m.columns[pair.second];
    Row row{std::string(info(m.metric).label), fmt::format("{} - {}", first.values.name, second.values.name),
            shown_text(first.mean - second.mean, m.metric),
            m.chosen == ChosenTest::kFriedman ? "Dunn" : "Bonferroni", cell(m.p_of(pair), p_cell)};
    if (!full) return row;
    const std::optional<MeanPair>& by_means = m.by_means(pair);
    row.push_back(cell(by_means, [&](const MeanPair& p) { return range(p.interval, m.metric); }));
    row.push_back(
        cell(by_means, [&](const MeanPair& p) { return range(p.interval_simultaneous, m.metric); }));
    row.push_back(cell(by_means, [](const MeanPair& p) { return p_cell(p.p_holm); }));
    row.push_back(cell(pair.d_z, [](const CohensDz& d) {
        return fmt::format("{:.2f} ({:.2f} to {:.2f})", d.d_z, d.interval.low, d.interval.high);
    }));
    return row;
}

ReportTable pair_table(const std::vector<MeasureAnalysis>& measures, bool full) {
    ReportTable table{"Pairs of modalities", "", {"measure", "pair", "difference", "by", "P"}};
    if (full) {
        table.columns.insert(table.columns.end(),
                             {"95 % CI", "95 % CI, all at once", "P (Holm)", "d_z (95 % CI)"});
        table.note =
            "Intervals and Holm's P come from the subjects' own differences (paired t); in experiment 2 from "
            "the error of the ANOVA.";
    }
    for (const MeasureAnalysis& m : measures) {
        for (const PairAnalysis& pair : m.pairs) table.rows.push_back(pair_row(m, pair, full));
    }
    return table;
}

}  // namespace

std::vector<ReportTable> analysis_tables(const std::vector<MeasureAnalysis>& measures) {
    if (measures.empty()) return {};
    const bool full = measures.front().kind == AnalysisKind::kFull;
    std::vector<ReportTable> tables;
    for (ReportTable& table :
         std::vector{test_table(measures, full), column_table(measures), pair_table(measures, full)}) {
        if (!table.rows.empty()) tables.push_back(std::move(table));
    }
    return tables;
}

}  // namespace thimble
