// gnuplot: data and scripts in, SVG and PDF out.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "common/colours.hpp"

namespace thimble {

// The lines every script begins with: terminal, output, fonts, borders. With the lines that are put behind it
// (draw_with_gnuplot) a script draws itself twice: NAME.svg, then, where gnuplot has pdfcairo, NAME.pdf.
std::string gnuplot_preamble(const std::string& name, int width_px, int height_px);

// One value and a tab; NaN as gnuplot's missing value. Six digits are more than any picture shows.
void write_cell(std::string& data, double value);

// "10", or "9-10" where panels differ.
std::string range_text(std::size_t low, std::size_t high);

// "'HF' 0, 'CF' 1": the tics of an axis, label(i) at i.
template <class Label>
std::string numbered_tics(std::size_t count, const Label& label) {
    std::string tics;
    for (std::size_t i = 0; i < count; ++i) tics += fmt::format("{}'{}' {}", i > 0 ? ", " : "", label(i), i);
    return tics;
}

// A figure: NAME.svg is drawn by `gnuplot -d NAME.gp` beside NAME.tsv.
struct FigureSource {
    std::string name, title, caption;
    std::string data, script;  // NAME.tsv, NAME.gp
};
// Writes NAME.tsv and NAME.gp of each into `directory`, made if missing, and removes its pictures of earlier runs. One
// process draws them all, since half of a small figure's time is gnuplot's start. Returns gnuplot's complaint, nothing if
// all went well; figures behind the failed one are not drawn. Throws Error (run failed) that names a file that cannot be
// written, or says what to install if gnuplot cannot be started.
std::optional<std::string> draw_with_gnuplot(const std::filesystem::path& directory,
                                             const std::vector<FigureSource>& figures);
// From here on draw_with_gnuplot throws Error (run failed), as where gnuplot is missing: for a process that only calculates.
void draw_nothing();
// The <svg> element of NAME.svg, its ids prefixed with the name so that several can stand in one page; nothing if it is
// not there to its end.
std::optional<std::string> drawn_svg(const std::filesystem::path& directory, const std::string& name);

// All of it for one picture. Throws Error (run failed) that says what to install or what gnuplot complained
// about.
std::string run_gnuplot(const std::filesystem::path& directory, const std::string& name,
                        const std::string& data, const std::string& script);

}  // namespace thimble
