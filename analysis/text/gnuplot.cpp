#include "analysis/text/gnuplot.hpp"

#include <cmath>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/process/child.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

constexpr const char* kRemedy = "install gnuplot (Debian: gnuplot-nox) to get the figures";

bool& draws_nothing() {
    static bool nothing = false;
    return nothing;
}

// Behind every script: the same again as PDF, a vector format that print shops and LaTeX take.
std::string once_more_as_pdf(const std::string& name) {
    return fmt::format(R"(unset output
if (!exists("as_pdf") && strstrt(GPVAL_TERMINALS, "pdfcairo") > 0) {{
    as_pdf = 1
    load '{}.gp'
    undefine as_pdf
}}
)",
                       name);
}

// The text of a figure that was drawn to its end, else nothing.
std::string svg_file(const std::filesystem::path& directory, const std::string& name) {
    std::string svg = read_text_file(directory / (name + ".svg"));
    return svg.find("</svg>") == std::string::npos ? std::string() : svg;
}

// A PDF carries the second it was made in; without it the same figure is the same bytes.
void forget_date(const std::filesystem::path& pdf) {
    constexpr std::string_view kKey = "/CreationDate (D:", kDate = "19700101000000";
    std::string bytes = read_text_file(pdf);
    const std::size_t at = bytes.rfind(kKey);
    if (at == std::string::npos || at + kKey.size() + kDate.size() > bytes.size()) return;
    bytes.replace(at + kKey.size(), kDate.size(), kDate);
    write_text_file(pdf, bytes);
}

// boost::replace_all would move the rest of the text byte by byte.
std::string with_behind_each(std::string_view text, std::string_view mark, std::string_view added) {
    std::string longer;
    longer.reserve(text.size() + text.size() / 8);
    for (std::size_t at = text.find(mark); at != std::string_view::npos; at = text.find(mark)) {
        longer.append(text.substr(0, at + mark.size())).append(added);
        text.remove_prefix(at + mark.size());
    }
    return longer.append(text);
}

// Without XML declaration, DOCTYPE and comments, which may not stand inside HTML or name outside addresses;
// with ids of its own, since gnuplot gives the same ones to every figure.
std::string embeddable_svg(std::string text, const std::string& name) {
    text.erase(0, text.find("<svg"));
    const std::string own = name + "-";
    for (const char* before : {"id=\"", "id='", "xlink:href='#", "xlink:href=\"#", "url(#"})
        text = with_behind_each(text, before, own);
    return text;
}

}  // namespace

std::string gnuplot_preamble(const std::string& name, int width_px, int height_px) {
    constexpr double kPixelsPerInch = 100;
    return fmt::format(
        R"(reset
if (exists("as_pdf")) {{
    set terminal pdfcairo size {}in,{}in font 'DejaVu Sans,13' linewidth 1.2 background 'white'
    set output '{name}.pdf'
}} else {{
    set terminal svg size {},{} font 'DejaVu Sans,Helvetica,Arial,sans-serif,13' linewidth 1.2 background 'white'
    # A browser shows each <title> under the pointer: "Gnuplot", "gnuplot_plot_1a".
    set output "| sed 's,<title>[^<]*</title>,,' > '{name}.svg'"
}}
set datafile missing 'NaN'
set encoding utf8; set minussign
set border 3 linecolor '#444444'
set tics nomirror out scale 0.6 textcolor '#222222'
)",
        width_px / kPixelsPerInch, height_px / kPixelsPerInch, width_px, height_px, fmt::arg("name", name));
}

void write_cell(std::string& data, double value) {
    data += std::isnan(value) ? "NaN\t" : fmt::format("{:.6g}\t", value);
}

std::string range_text(std::size_t low, std::size_t high) {
    return low == high ? fmt::format("{}", low) : fmt::format("{}-{}", low, high);
}

void draw_nothing() { draws_nothing() = true; }

std::optional<std::string> draw_with_gnuplot(const std::filesystem::path& directory,
                                             const std::vector<FigureSource>& figures) {
    if (draws_nothing()) throw Error(ExitCode::kRunFailed, "figures are switched off for this process");
    std::error_code failure;
    std::filesystem::create_directories(directory, failure);  // what went wrong shows when writing
    std::vector<std::string> arguments{"-d"};
    for (const FigureSource& figure : figures) {
        write_text_file(directory / (figure.name + ".tsv"), figure.data);
        write_text_file(directory / (figure.name + ".gp"), figure.script + once_more_as_pdf(figure.name));
        // A picture of an earlier run must not pass for this one.
        for (const char* picture : {".svg", ".pdf"})
            std::filesystem::remove(directory / (figure.name + picture), failure);
        arguments.push_back(figure.name + ".gp");
    }
    const ProgramResult result = run_program("gnuplot", arguments, directory, kRemedy);
    std::string missing;
    for (const FigureSource& figure : figures) {
        if (svg_file(directory, figure.name).empty()) missing += " " + figure.name;
        forget_date(directory / (figure.name + ".pdf"));
    }
    if (result.exit_code == 0 && missing.empty()) return std::nullopt;
    return fmt::format(
        "gnuplot failed in {} (exit code {}; not drawn:{}): {}; the scripts need gnuplot 5.4 with the svg "
        "terminal",
        directory.string(), result.exit_code, missing.empty() ? " nothing" : missing, result.output);
}

std::optional<std::string> drawn_svg(const std::filesystem::path& directory, const std::string& name) {
    const std::string svg = svg_file(directory, name);
    if (svg.empty()) return std::nullopt;
    return embeddable_svg(svg, name);
}

std::string run_gnuplot(const std::filesystem::path& directory, const std::string& name,
                        const std::string& data, const std::string& script) {
    if (const auto complaint = draw_with_gnuplot(directory, {{name, "", "", data, script}}))
        throw Error(ExitCode::kRunFailed, *complaint);
    return drawn_svg(directory, name).value_or("");
}

}  // namespace thimble
