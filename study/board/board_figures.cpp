#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "study/board/board_report.hpp"

namespace thimble {

namespace {

// A block of the data for the first front, one for the others. Labels of gnuplot's data stand in quotes.
std::string block(const std::vector<Contestant>& contestants, bool first_front) {
    std::string data;
    for (const Contestant& one : contestants) {
        if ((one.front == 1) != first_front || one.front == 0) continue;
        write_cell(data, 1000 * one.values[kDepth].mean);
        write_cell(data, one.values[kFelt].mean);
        data += fmt::format("\"{}{}\"\n", one.name,
                            one.stable_rows == one.rows
                                ? ""
                                : fmt::format(" ({:.0f} %)", std::ceil(100 * one.values[kUnstable].mean)));
    }
    return (data.empty() ? "NaN\tNaN\t\"\"\n" : data) + "\n\n";
}

}  // namespace

FigureSource pareto_figure(const std::vector<Contestant>& contestants) {
    double deepest_mm = 1;
    for (const Contestant& one : contestants)
        if (one.front > 0) deepest_mm = std::max(deepest_mm, 1000 * one.values[kDepth].mean);
    const std::string name = "board_pareto";
    std::string script = gnuplot_preamble(name, 860, 520);
    script += fmt::format(
        "set xrange [0:{0:.4g}]; set yrange [-0.06:1.12]\nset xlabel 'maximum penetration (mm), mean over "
        "conditions'\nset ylabel 'stiffness felt / true stiffness, mean over conditions'\nset key top "
        "right\nplot '{1}.tsv' index 0 using 1:2 with points pt 7 ps 1.1 lc rgb '{2}' title 'not dominated', "
        "\\\n     '' index 1 using 1:2 with points pt 6 ps 1.1 lc rgb '{3}' title 'dominated', \\\n     '' "
        "using 1:2:3 with labels left offset char 0.8,0.35 font ',11' noenhanced notitle\n",
        1.25 * deepest_mm, name, kBlue, kGrey);
    return {
        name, "Penetration and stiffness",
        "Up and to the left is better. In brackets, if there were any: the larger share of trials that "
        "oscillated, or that were not completed. Packets per second, the fourth objective, are in the table.",
        "# penetration (mm), stiffness, name\n" + block(contestants, true) + block(contestants, false),
        script};
}

}  // namespace thimble
