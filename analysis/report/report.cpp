#include "analysis/report/report.hpp"

#include <fstream>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/report/report_tables.hpp"
#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"

namespace thimble {
namespace {

// A stranger's first questions about the letters.
constexpr std::string_view kLegend =
    "<dl class=\"legend\">\n"
    "<dt>HF</dt><dd>force on the handle that the hand holds</dd>\n"
    "<dt>CF</dt><dd>fingertip devices on the acting hand, no force on the handle</dd>\n"
    "<dt>CCF</dt><dd>the same devices on the other hand</dd>\n"
    "<dt>VF</dt><dd>a bar on a screen</dd>\n"
    "<dt>Virtual fixture</dt><dd>the surface in the tissue at which the needle is to stop</dd>\n"
    "<dt>Oscillates</dt><dd>the needle leaves and meets the virtual fixture again and again</dd>\n"
    "<dt>Penetration</dt><dd>how far the needle is beyond the virtual fixture</dd>\n"
    "<dt>Delay</dt><dd>one way, on the path of the force</dd>\n</dl>\n";

std::string answers_html(const std::vector<Answer>& answers) {
    std::string html;
    for (const Answer& answer : answers) {
        html += "<div class=\"answer\">\n";
        if (!answer.of.empty()) html += html_element("h3", answer.of) + "\n";
        for (const std::string& sentence : answer.sentences) html += html_element("p", sentence) + "\n";
        html += "</div>\n";
    }
    return html + std::string(kLegend);
}

std::string figures_html(const ReportSection& section) {
    std::string html;
    if (!section.drawn.problem.empty()) {
        html += fmt::format("<p class=\"problem\">{}: {}</p>\n",
                            section.drawn.figures.empty() ? "No figures" : "Not all figures",
                            html_escape(section.drawn.problem));
    }
    for (const Figure& figure : section.drawn.figures) {
        html += fmt::format(
            "<section "
            "class=\"figure\">\n{}\n<figure>\n{}\n<figcaption>{}</figcaption>\n</figure>\n</section>\n",
            html_element("h3", figure.title), figure.svg, html_escape(figure.caption));
    }
    return html;
}

std::string words_html(const ReportSection& section, const std::string& title) {
    std::string html = html_element("h2", title) + "\n";
    if (!section.text.empty()) html += html_element("p", section.text) + "\n";
    for (const std::string& finding : section.findings) {
        html += fmt::format("<p class=\"finding\">{}</p>\n", html_escape(finding));
    }
    return html;
}

std::string tables_html(const ReportSection& section) {
    std::string html;
    for (const ReportTable& table : section.tables) {
        if (!table.rows.empty()) html += html_table(table);
    }
    return html;
}

bool says_something(const ReportSection& section) {
    return !section.text.empty() || !section.findings.empty() || !tables_html(section).empty();
}

// Answer and figures come first, the numbers behind them after.
std::string answered_html(const ReportInput& report) {
    std::string html = answers_html(report.answers);
    for (const ReportSection& section : report.sections) {
        const std::string figures = figures_html(section);
        if (!figures.empty()) html += html_element("h2", "Figures: " + section.title) + "\n" + figures;
    }
    for (const ReportSection& section : report.sections) {
        if (!says_something(section)) continue;
        const bool has_figures = !section.drawn.figures.empty();
        html +=
            words_html(section, (has_figures ? "Statistics: " : "") + section.title) + tables_html(section);
    }
    return html;
}

std::string plain_html(const ReportInput& report) {
    std::string html;
    for (const ReportSection& section : report.sections)
        html += words_html(section, section.title) + figures_html(section) + tables_html(section);
    return html;
}

std::string provenance_html(const ReportInput& report) {
    if (report.provenance.empty()) return "";
    ReportTable table{"Made with", "", {"what", "value"}};
    std::string folded;
    for (const auto& [key, value] : report.provenance) {
        if (value.find('\n') == std::string::npos) {
            table.rows.push_back({key, value});
        } else {
            folded += fmt::format("<details>\n{}\n{}\n</details>\n", html_element("summary", key),
                                  html_element("pre", value));
        }
    }
    return html_element("h2", "Provenance") + "\n" + html_table(table) + folded;
}

// Keeps the order of insertion. NaN becomes null.
using Json = nlohmann::ordered_json;

constexpr const char* kDigests = "sha256";
constexpr const char* kClock = "clock";

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

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& why) {
    throw Error(ExitCode::kData, fmt::format("{}: {}; name the --out folder of thimble run or thimble study",
                                             file.string(), why));
}

// Of the tables beside a summary, which is written last.
Json digests_in(const std::filesystem::path& folder) {
    std::map<std::string, std::string> digests;
    for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder)) {
        if (entry.path().extension() == ".csv")
            digests[entry.path().filename().string()] = sha256_of_file(entry.path());
    }
    return digests;
}

// Figures and numbers of the summary are those of the tables that it was made from.
void require_tables(const Json& digests, const std::filesystem::path& folder) {
    for (const auto& [name, digest] : digests.items()) {
        const std::string now = sha256_of_file(folder / name);
        if (now == digest.get<std::string>()) continue;
        throw Error(ExitCode::kData,
                    "{}: {} since summary.json was written, so the two do not agree: restore the file, or "
                    "repeat the run (thimble analyse reads a changed table)",
                    (folder / name).string(), now.empty() ? "is gone" : "was changed");
    }
}

// Of the commands that write a summary, only run has a clock, and only run and study have a design.
void require_command(const Json& json, const std::filesystem::path& folder, const std::string& command) {
    const bool is_run = json.contains(kClock);
    if (is_run == (command == "run") && json.at("provenance").contains(kDesign)) return;
    throw Error(ExitCode::kUsage,
                "{}: thimble {} did not write this folder: --run takes a folder of thimble run, --study one "
                "of thimble study",
                folder.string(), command);
}

Figure read_figure(const Json& json, const std::filesystem::path& folder) {
    Figure figure;
    figure.name = json.at("name").get<std::string>();
    figure.title = json.at("title").get<std::string>();
    figure.caption = json.at("caption").get<std::string>();
    const auto svg = drawn_svg(folder / "figures", figure.name);
    if (!svg) fail(folder / "figures" / (figure.name + ".svg"), "this figure cannot be read");
    figure.svg = *svg;
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
    for (const Json& figure : json.at("figures"))
        section.drawn.figures.push_back(read_figure(figure, folder));
    section.drawn.problem = json.value("figures_problem", "");
    for (const Json& table : json.at("tables")) section.tables.push_back(read_table(table));
    return section;
}

void add_folder(ReportInput& report, const std::filesystem::path& folder, const std::string& what,
                const std::string& title) {
    if (folder.empty()) return;
    const auto path = folder / "summary.json";
    std::ifstream file(path);
    if (!file) fail(path, "cannot be read");
    try {
        const Json json = Json::parse(file);
        require_command(json, folder, what);
        require_tables(json.value(kDigests, Json::object()), folder);
        const std::string of = json.value(kClock, "") == "virtual" ? "Virtual time" : title;
        if (json.contains("answer"))
            report.answers.push_back({of, json.at("answer").get<std::vector<std::string>>()});
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

ReportSection trials_section(std::string title, const std::vector<TrialRow>& rows,
                             const std::vector<GroupFindings>& findings, DrawnFigures drawn) {
    ReportSection section;
    section.title = std::move(title);
    section.text = fmt::format("{}.", counted(rows.size(), "trial"));
    section.conditions = summarize(rows);
    section.drawn = std::move(drawn);
    section.tables = finding_tables(findings);
    section.tables.push_back(metrics_table(section.conditions));
    section.tables.push_back(oscillation_table(section.conditions));
    return section;
}

ReportSection agreement_section(const std::vector<TrialRow>& real,
                                const std::vector<TrialRow>& in_virtual_time) {
    Agreement agreement = compare_trials(real, in_virtual_time);
    ReportSection section;
    section.title = "Real processes compared with virtual time";
    section.text = fmt::format(
        "The class agrees in {} of {} trials that both have. {} real trials have no counterpart in virtual "
        "time, or did not run to their end.",
        agreement.same_class, agreement.compared, agreement.unmatched);
    section.tables = {std::move(agreement.metrics), std::move(agreement.classes)};
    return section;
}

void say_virtual_subjects(ReportInput& report) {
    const std::string first = "The subjects are virtual: a model of a person did every trial.";
    report.title += ", virtual subjects";
    if (!report.answers.empty()) {
        std::vector<std::string>& sentences = report.answers.front().sentences;
        sentences.insert(sentences.begin(), first);
    } else if (!report.sections.empty()) {
        std::string& text = report.sections.front().text;
        text = text.empty() ? first : first + " " + text;
    }
    for (ReportSection& section : report.sections) {
        for (Figure& figure : section.drawn.figures) figure.caption += " Virtual subjects.";
    }
    report.provenance.emplace_back("kind of subjects", "virtual");
}

void write_report(const ReportInput& report, const std::filesystem::path& html) {
    std::string body = html_element("h1", report.title) + "\n";
    body += report.answers.empty() ? plain_html(report) : answered_html(report);
    body += provenance_html(report);
    write_text_file(html, html_page(report.title, body));
}

void write_summary(const ReportInput& report, const std::filesystem::path& json_path) {
    Json json{{"title", report.title}};
    for (const Answer& answer : report.answers) json["answer"] = answer.sentences;
    if (report.time) {
        json[kClock] = report.time->clock;
        json["simulated_s"] = report.time->simulated_s;
        json["wall_s"] = report.time->wall_s;
    }
    json["provenance"] = Json::object();
    for (const auto& [key, value] : report.provenance) json["provenance"][key] = value;
    json["sections"] = Json::array();
    for (const ReportSection& section : report.sections) json["sections"].push_back(to_json(section));
    json[kDigests] = digests_in(json_path.parent_path());
    write_text_file(json_path, json_text(json, 2) + "\n");
}

std::vector<Answer> write_combined_report(const std::filesystem::path& run,
                                          const std::filesystem::path& study,
                                          const std::filesystem::path& html, const std::string& command) {
    if (run.empty() && study.empty()) {
        throw Error(ExitCode::kUsage, "nothing to report: give --run FOLDER, --study FOLDER or both");
    }
    ReportInput report;
    report.title = "Thimble: results";
    add_folder(report, study, "study", "Virtual study");
    add_folder(report, run, "run", "Real processes");
    report.provenance.emplace_back("command", command);
    report.provenance.emplace_back("version", kVersion);
    make_folder(html.parent_path());
    write_report(report, html);
    return report.answers;
}

std::optional<std::string> design_in(const std::filesystem::path& folder) {
    std::ifstream file(folder / "summary.json");
    if (!file) return std::nullopt;
    const Json summary = Json::parse(file, nullptr, false);
    if (summary.is_discarded() || !summary.is_object()) return std::nullopt;
    const Json provenance = summary.value("provenance", Json::object());
    if (!provenance.is_object() || !provenance.contains(kDesign) || !provenance[kDesign].is_string())
        return std::nullopt;
    return provenance[kDesign].get<std::string>();
}

}  // namespace thimble
