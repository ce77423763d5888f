#include <nlohmann/json.hpp>

#include "analysis/report/report.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

// Keeps the order of insertion. NaN becomes null.
using Json = nlohmann::ordered_json;

Json to_json(const Headline& headline) {
    return {{"claim", headline.claim()},
            {"delay_s", headline.delay_s},
            {"verdict", to_string(headline.verdict)},
            {"supported", headline.verdict == Verdict::kSupported},
            {"reasons", headline.reasons},
            {"sentence", headline.sentence()}};
}

Json to_json(const ConditionSummary& condition) {
    Json json{{"modality", to_string(condition.modality)},
              {"delay_s", condition.delay_s},
              {"trials", condition.trials},
              {"judged", condition.judged},
              {"oscillating", condition.oscillating},
              {"beeped", condition.beeped},
              {"subjects", condition.subjects}};
    for (std::size_t i = 0; i < kMetrics; ++i) {
        const Statistic& statistic = condition.statistics[i];
        json["metrics"][std::string(info(static_cast<Metric>(i)).name)] = {
            {"mean", statistic.mean}, {"sd", statistic.sd}, {"n", statistic.n}};
    }
    return json;
}

Json to_json(const ReportTable& table) {
    return {{"title", table.title}, {"note", table.note}, {"columns", table.columns}, {"rows", table.rows}};
}

Json to_json(const ReportSection& section) {
    Json json{{"title", section.title}, {"text", section.text}};
    if (!section.findings.empty()) json["findings"] = section.findings;
    if (section.headline) json["headline"] = to_json(*section.headline);
    json["conditions"] = Json::array();
    for (const ConditionSummary& condition : section.conditions)
        json["conditions"].push_back(to_json(condition));
    json["figures"] = Json::array();
    for (const Figure& figure : section.drawn.figures) {
        json["figures"].push_back(
            {{"name", figure.name}, {"title", figure.title}, {"caption", figure.caption}});
    }
    if (!section.drawn.problem.empty()) json["figures_problem"] = section.drawn.problem;
    json["tables"] = Json::array();
    for (const ReportTable& table : section.tables) json["tables"].push_back(to_json(table));
    return json;
}

}  // namespace

void write_summary(const ReportInput& report, const std::filesystem::path& json_path) {
    Json json{{"title", report.title}};
    json["provenance"] = Json::object();
    for (const auto& [key, value] : report.provenance) json["provenance"][key] = value;
    json["sections"] = Json::array();
    for (const ReportSection& section : report.sections) json["sections"].push_back(to_json(section));
    write_text_file(json_path, json_text(json, 2) + "\n");
}

}  // namespace thimble
