#include <type_traits>

#include <nlohmann/json.hpp>

#include "analysis/analysis.hpp"

namespace thimble {
namespace {

// Keeps the order of insertion.
using Json = nlohmann::ordered_json;

Json to_json(const ConfidenceInterval& interval) { return {interval.low, interval.high}; }

Json to_json(const Normality& test) {
    return {{"skewness", test.skewness},
            {"kurtosis", test.kurtosis},
            {"k2", test.k2},
            {"p", test.p},
            {"normal", test.p >= kAnalysisLevel}};
}

template <class Value>
Json or_null(const std::optional<Value>& value) {
    if (!value) return nullptr;
    if constexpr (std::is_arithmetic_v<Value>) {
        return *value;
    } else {
        return to_json(*value);
    }
}

Json to_json(const ColumnAnalysis& column) {
    return {{"modality", column.values.name},
            {"n", column.values.values.size()},
            {"mean", column.mean},
            {"sd", or_null(column.sd)},
            {"mean_interval", or_null(column.mean_interval)},
            {"median", column.median},
            {"quartiles", {column.lower_quartile, column.upper_quartile}},
            {"normality", or_null(column.normality)}};
}

Json to_json(const RepeatedAnova& anova, bool full, const std::optional<ConfidenceInterval>& eta_squared) {
    Json json{{"f", anova.f}, {"df", {anova.df_conditions, anova.df_error}}, {"p", anova.p}};
    if (!full) return json;
    json["epsilon_greenhouse_geisser"] = anova.epsilon_greenhouse_geisser;
    json["p_greenhouse_geisser"] = anova.p_greenhouse_geisser;
    json["epsilon_huynh_feldt"] = anova.epsilon_huynh_feldt;
    json["p_huynh_feldt"] = anova.p_huynh_feldt;
    json["partial_eta_squared"] = anova.partial_eta_squared;
    json["partial_eta_squared_interval"] = or_null(eta_squared);
    json["generalised_eta_squared"] = anova.generalised_eta_squared;
    return json;
}

Json to_json(const OneWayAnova& anova, bool full, const std::optional<ConfidenceInterval>& eta_squared) {
    Json json{{"f", anova.f}, {"df", {anova.df_between, anova.df_within}}, {"p", anova.p}};
    if (!full) return json;
    json["eta_squared"] = anova.eta_squared;
    json["eta_squared_interval"] = or_null(eta_squared);
    return json;
}

Json to_json(const Friedman& test, bool full) {
    Json json{{"chi_squared", test.chi_squared},
              {"df", test.df},
              {"p", test.p()},
              {"p_exact", or_null(test.p_exact)},
              {"p_asymptotic", test.p_asymptotic},
              {"mean_ranks", test.mean_ranks}};
    if (full) json["kendalls_w"] = test.kendalls_w;
    return json;
}

Json to_json(const MeanPair& pair, bool full) {
    Json json{{"t", pair.t}, {"df", pair.df}, {"p", pair.p}, {"p_bonferroni", pair.p_bonferroni}};
    if (!full) return json;
    json["p_holm"] = pair.p_holm;
    json["interval"] = to_json(pair.interval);
    json["interval_simultaneous"] = to_json(pair.interval_simultaneous);
    return json;
}

Json to_json(const DunnPair& pair) {
    return {{"mean_rank_difference", pair.mean_rank_difference},
            {"z", pair.z},
            {"p", pair.p},
            {"p_adjusted", pair.p_adjusted}};
}

Json to_json(const CohensDz& d_z) { return {{"d_z", d_z.d_z}, {"interval", to_json(d_z.interval)}}; }

Json to_json(const PairAnalysis& pair, const MeasureAnalysis& m) {
    const bool full = m.kind == AnalysisKind::kFull;
    const ColumnAnalysis& first = m.columns[pair.first];
    const ColumnAnalysis& second = m.columns[pair.second];
    Json json{{"first", first.values.name},
              {"second", second.values.name},
              {"difference", first.mean - second.mean},
              {"p", or_null(m.p_of(pair))}};
    if (pair.pooled) json["pooled_error"] = to_json(*pair.pooled, full);
    if (pair.dunn) json["dunn"] = to_json(*pair.dunn);
    if (pair.paired) json["paired_t"] = to_json(*pair.paired, full);
    if (pair.d_z) json["cohens_d_z"] = to_json(*pair.d_z);
    return json;
}

Json to_json(const MeasureAnalysis& m) {
    const bool full = m.kind == AnalysisKind::kFull;
    Json json{{"experiment", m.experiment},
              {"measure", info(m.metric).name},
              {"design", m.within_subjects ? "within subjects" : "between groups"},
              {m.within_subjects ? "subjects" : "trials", m.subjects},
              {"left_out", m.left_out},
              {"test", to_string(m.chosen)},
              {"p", or_null(m.p())},
              {"differs", m.p() ? Json(m.differs()) : Json()},
              {"finding", finding_text(m)}};
    json["modalities"] = Json::array();
    for (const ColumnAnalysis& column : m.columns) json["modalities"].push_back(to_json(column));
    if (m.repeated_anova) json["repeated_anova"] = to_json(*m.repeated_anova, full, m.eta_squared_interval);
    if (m.one_way_anova) json["one_way_anova"] = to_json(*m.one_way_anova, full, m.eta_squared_interval);
    if (m.friedman) json["friedman"] = to_json(*m.friedman, full);
    json["pairs"] = Json::array();
    for (const PairAnalysis& pair : m.pairs) json["pairs"].push_back(to_json(pair, m));
    json["problems"] = m.problems;
    return json;
}

}  // namespace

nlohmann::ordered_json to_json(const std::vector<MeasureAnalysis>& measures, AnalysisKind kind) {
    Json json{{"analysis", to_string(kind)}, {"level", kAnalysisLevel}};
    json["measures"] = Json::array();
    for (const MeasureAnalysis& measure : measures) json["measures"].push_back(to_json(measure));
    return json;
}

}  // namespace thimble
