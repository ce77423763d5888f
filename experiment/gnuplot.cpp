#include "experiment/gnuplot.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"
#include "experiment/subprocess.hpp"
#include "experiment/text_file.hpp"

namespace thimble {
namespace {

constexpr const char* kRemedy = "install gnuplot (Debian: gnuplot-nox) to get the figures";

void replace_all(std::string& text, std::string_view from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
        text.replace(at, from.size(), to);
    }
}

// Without XML declaration, DOCTYPE and comments, which may not stand inside HTML or name outside addresses;
// with ids of its own, since gnuplot gives the same ones to every figure.

}  // namespace

std::string embeddable_svg(std::string text, const std::string& name) {
    text.erase(0, text.find("<svg"));
    replace_all(text, "id=\"", "id=\"" + name + "-");
    replace_all(text, "id='", "id='" + name + "-");
    replace_all(text, "xlink:href='#", "xlink:href='#" + name + "-");
    replace_all(text, "xlink:href=\"#", "xlink:href=\"#" + name + "-");
    replace_all(text, "url(#", "url(#" + name + "-");
    return text;
}

std::string gnuplot_preamble(const std::string& name, int width_px, int height_px) {
    return fmt::format(
        R"(set terminal svg size {},{} font 'DejaVu Sans,Helvetica,Arial,sans-serif,13' linewidth 1.2 background 'white'
set output '{}.svg'
set datafile missing 'NaN'
set border 3 linecolor '#444444'
set tics nomirror out scale 0.6 textcolor '#222222'
)",
        width_px, height_px, name);
}

void write_cell(std::string& data, double value) {
    data += std::isnan(value) ? "NaN\t" : fmt::format("{:.6g}\t", value);
}

std::string range_text(std::uint32_t low, std::uint32_t high) {
    return low == high ? fmt::format("{}", low) : fmt::format("{}-{}", low, high);
}

std::string run_gnuplot(const std::filesystem::path& directory, const std::string& name,
                        const std::string& data, const std::string& script) {
    std::error_code failure;
    std::filesystem::create_directories(directory, failure);  // what went wrong shows when writing
    write_text_file(directory / (name + ".tsv"), data);
    write_text_file(directory / (name + ".gp"), script);
    const std::filesystem::path picture = directory / (name + ".svg");
    std::filesystem::remove(picture, failure);  // a picture of an earlier run must not pass for this one

    const ProgramResult result = run_program("gnuplot", {"-d", name + ".gp"}, directory, kRemedy);
    std::ifstream in(picture, std::ios::binary);
    std::string svg{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (result.exit_code != 0 || svg.find("</svg>") == std::string::npos) {
        throw Error(
            ExitCode::kRunFailed,
            fmt::format(
                "gnuplot failed on {} (exit code {}): {}; the script needs gnuplot 5.4 with the svg terminal",
                (directory / (name + ".gp")).string(), result.exit_code, result.output));
    }
    return embeddable_svg(std::move(svg), name);
}

}  // namespace thimble
