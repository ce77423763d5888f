#include "analysis/report/report.hpp"

#include <utility>

#include <fmt/format.h>

#include "analysis/report/report_tables.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

const char* css_class(Verdict verdict) {
    switch (verdict) {
        case Verdict::kSupported:
            return "headline supported";
        case Verdict::kNotSupported:
            return "headline not-supported";
        case Verdict::kNotJudged:
            break;
    }
    return "headline";
}

std::string headlines_html(const ReportInput& report) {
    std::string html;
    for (const ReportSection& section : report.sections) {
        if (!section.headline) continue;
        html += fmt::format("<p class=\"{}\"><b>{}.</b> {}</p>\n", css_class(section.headline->verdict),
                            html_escape(section.title), html_escape(section.headline->sentence()));
    }
    return html;
}

std::string section_html(const ReportSection& section) {
    std::string html = html_element("h2", section.title) + "\n";
    if (!section.text.empty()) html += html_element("p", section.text) + "\n";
    for (const std::string& finding : section.findings) {
        html += fmt::format("<p class=\"finding\">{}</p>\n", html_escape(finding));
    }
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
    for (const ReportTable& table : section.tables) html += html_table(table);
    return html;
}

std::string provenance_html(const ReportInput& report) {
    if (report.provenance.empty()) return "";
    ReportTable table{"Made with", "", {"what", "value"}, {}};
    for (const auto& [key, value] : report.provenance) table.rows.push_back({key, value});
    return html_element("h2", "Provenance") + "\n" + html_table(table);
}

}  // namespace

ReportSection trials_section(std::string title, const std::vector<TrialRow>& rows, DrawnFigures drawn,
                             double headline_delay_s) {
    ReportSection section;
    section.title = std::move(title);
    section.text = fmt::format("{} trials.", rows.size());
    section.conditions = summarize(rows);
    section.headline = judge_headline(section.conditions, headline_delay_s);
    section.drawn = std::move(drawn);
    section.tables = {class_table(section.conditions), oscillation_table(section.conditions),
                      metrics_table(section.conditions)};
    return section;
}

ReportSection agreement_section(const std::vector<TrialRow>& real,
                                const std::vector<TrialRow>& in_virtual_time) {
    Agreement agreement = compare_trials(real, in_virtual_time);
    ReportSection section;
    section.title = "Real processes against virtual time";
    section.text = fmt::format(
        "The class agrees in {} of {} trials that both have. {} real trials have no counterpart or did not "
        "run to "
        "their end.",
        agreement.same_class, agreement.compared, agreement.unmatched);
    section.tables = {std::move(agreement.metrics), std::move(agreement.classes)};
    return section;
}

void write_report(const ReportInput& report, const std::filesystem::path& html) {
    std::string body = html_element("h1", report.title) + "\n" + headlines_html(report);
    for (const ReportSection& section : report.sections) body += section_html(section);
    body += provenance_html(report);
    write_text_file(html, html_page(report.title, body));
}

}  // namespace thimble
