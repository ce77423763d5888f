#include "study/sweeps/survival_figure.hpp"

#include <fmt/format.h>

#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

// A line per cell: column, row from the top, percent.
std::string cells(const Variation& variation, const std::vector<std::size_t>& indices) {
    std::string data = "# point, claim, percent of seeds\n";
    for (std::size_t x = 0; x < variation.points.size(); ++x) {
        for (std::size_t y = 0; y < indices.size(); ++y) {
            write_cell(data, static_cast<double>(x));
            write_cell(data, static_cast<double>(y));
            write_cell(data, 100 * variation.points[x].tally.counts()[indices[y]].fraction());
            data.back() = '\n';
        }
        data += '\n';
    }
    return data;
}

std::string tics(const Variation& variation, const std::vector<std::size_t>& indices) {
    std::string x, y;
    for (std::size_t i = 0; i < variation.points.size(); ++i) {
        x += fmt::format("{}'{:g}' {}", i > 0 ? ", " : "", variation.points[i].value, i);
    }
    const auto& claims = variation.points.front().tally.counts();
    for (std::size_t i = 0; i < indices.size(); ++i) {
        y += fmt::format("{}'{}' {}", i > 0 ? ", " : "", claims[indices[i]].claim.id, i);
    }
    return fmt::format("set xtics ({})\nset ytics ({})\n", x, y);
}

std::string script(const Variation& variation, const std::vector<std::size_t>& indices,
                   const std::string& name) {
    const int height = 130 + 24 * static_cast<int>(indices.size());
    std::string text = gnuplot_preamble(name, 900, height);
    text += tics(variation, indices);
    text += fmt::format(
        "set xlabel '{}' noenhanced\nset ytics noenhanced\nunset key\n"
        "set xrange [-0.5:{}]\nset yrange [{}:-0.5]\n"
        "set palette defined (0 'white', 100 '{}')\nset cbrange [0:100]\nset cblabel 'percent of seeds'\n"
        "plot '{}.tsv' using 1:2:3 with image pixels, \\\n"
        "     '' using 1:2:(sprintf('%.0f', $3)) with labels font ',11' textcolor '#222222'\n",
        variation.range.name(), static_cast<double>(variation.points.size()) - 0.5,
        static_cast<double>(indices.size()) - 0.5, kSkyBlue, name);
    return text;
}

}  // namespace

DrawnFigures draw_survival(const Variation& variation, const std::filesystem::path& output) {
    DrawnFigures drawn;
    Figure figure;
    figure.name = "survival_" + variation.range.name();
    figure.title = "Claims that survive";
    figure.caption =
        fmt::format("Percent of seeds in which each claim comes out, over {}.", variation.range.name());
    try {
        const std::vector<std::size_t> indices = shown_claims(variation);
        const auto directory = output / "figures";
        make_folder(directory);
        figure.svg = run_gnuplot(directory, figure.name, cells(variation, indices),
                                 script(variation, indices, figure.name));
        drawn.figures.push_back(std::move(figure));
    } catch (const Error& error) {
        drawn.problem = error.what();
    }
    return drawn;
}

}  // namespace thimble
