#include "analysis/report/combined_report.hpp"

#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/report/report.hpp"
#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& why) {
    throw Error(ExitCode::kData, fmt::format("{}: {}; is this the --out folder of a thimble run or study?",
                                             file.string(), why));
}

Verdict verdict_of(const std::string& text) {
    for (const Verdict verdict : {Verdict::kSupported, Verdict::kNotSupported}) {
        if (text == to_string(verdict)) return verdict;
    }
    return Verdict::kNotJudged;
}

Headline read_headline(const Json& json) {
    Headline headline;
    headline.delay_s = json.at("delay_s").get<double>();
    headline.verdict = verdict_of(json.at("verdict").get<std::string>());
    headline.reasons = json.at("reasons").get<std::vector<std::string>>();
    return headline;
}

Figure read_figure(const Json& json, const std::filesystem::path& folder) {
    Figure figure;
    figure.name = json.at("name").get<std::string>();
    figure.title = json.at("title").get<std::string>();
    figure.caption = json.at("caption").get<std::string>();
    const auto path = folder / "figures" / (figure.name + ".svg");
    std::ifstream file(path);
    std::ostringstream text;
    if (!file || !(text << file.rdbuf())) fail(path, "this figure cannot be read");
    figure.svg = embeddable_svg(text.str(), figure.name);
    return figure;
}

ReportTable read_table(const Json& json) {
    return {json.at("title").get<std::string>(), json.at("note").get<std::string>(),
            json.at("columns").get<std::vector<std::string>>(),
            json.at("rows").get<std::vector<std::vector<std::string>>>()};
}

ReportSection read_section(const Json& json, const std::filesystem::path& folder) {
    ReportSection section;
    section.title = json.at("title").get<std::string>();
    section.text = json.at("text").get<std::string>();
    section.findings = json.value("findings", std::vector<std::string>{});
    if (json.contains("headline")) section.headline = read_headline(json.at("headline"));
    for (const Json& figure : json.at("figures"))
        section.drawn.figures.push_back(read_figure(figure, folder));
    section.drawn.problem = json.value("figures_problem", "");
    for (const Json& table : json.at("tables")) section.tables.push_back(read_table(table));
    return section;
}

void add_folder(ReportInput& report, const std::filesystem::path& folder, const std::string& what) {
    if (folder.empty()) return;
    const auto path = folder / "summary.json";
    std::ifstream file(path);
    if (!file) fail(path, "cannot be read");
    try {
        const Json json = Json::parse(file);
        for (const Json& section : json.at("sections"))
            report.sections.push_back(read_section(section, folder));
        for (const auto& [key, value] : json.at("provenance").items()) {
            report.provenance.emplace_back(fmt::format("{}: {}", what, key), value.get<std::string>());
        }
    } catch (const Json::exception& error) {
        fail(path, error.what());
    }
}

}  // namespace

void write_combined_report(const std::filesystem::path& run, const std::filesystem::path& study,
                           const std::filesystem::path& html, const std::string& command) {
    if (run.empty() && study.empty()) {
        throw Error(ExitCode::kUsage, "nothing to report: give --run FOLDER, --study FOLDER or both");
    }
    ReportInput report;
    report.title = "Thimble: the 50 ms delay experiment";
    add_folder(report, study, "study");
    add_folder(report, run, "run");
    report.provenance.emplace_back("command", command);
    report.provenance.emplace_back("version", kVersion);
    make_folder(html.parent_path());
    write_report(report, html);
}

}  // namespace thimble
