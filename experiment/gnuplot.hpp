// One run of gnuplot: data and script in, SVG out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace thimble {

// Okabe and Ito (2008): told apart with every common form of colour blindness.
inline constexpr std::string_view kBlue = "#0072B2";
inline constexpr std::string_view kVermilion = "#D55E00";
inline constexpr std::string_view kSkyBlue = "#56B4E9";
inline constexpr std::string_view kGreen = "#009E73";
inline constexpr std::string_view kPurple = "#CC79A7";
inline constexpr std::string_view kGrey = "#999999";

// The lines every script begins with: terminal, output, fonts, borders.
std::string gnuplot_preamble(const std::string& name, int width_px, int height_px);

// One value and a tab; NaN as gnuplot's missing value. Six digits are more than any picture shows.
void write_cell(std::string& data, double value);

// "10", or "9-10" where panels differ.
std::string range_text(std::uint32_t low, std::uint32_t high);

// The <svg> element of a whole SVG file, its ids prefixed with `name` so that several can stand in one page.
std::string embeddable_svg(std::string text, const std::string& name);

// Writes NAME.tsv and NAME.gp into `directory`, runs gnuplot there and returns the <svg> element of NAME.svg,
// its ids prefixed with the name. Throws Error (run failed) that says what to install or what gnuplot
// complained about.
std::string run_gnuplot(const std::filesystem::path& directory, const std::string& name,
                        const std::string& data, const std::string& script);

}  // namespace thimble
