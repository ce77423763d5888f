#include "bench/work_precision/figure.hpp"

#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "analysis/text/gnuplot.hpp"
#include "bench/work_precision/tables.hpp"

namespace thimble {

namespace {

constexpr const char* kName = "work_precision";
constexpr int kPanelWidth_px = 500;
constexpr int kPanelHeight_px = 400;
constexpr int kLegend_px = 70;

// An error of nothing has no place on a logarithmic axis.
constexpr double kLeastError_m = 1e-19;

constexpr std::array<std::string_view, 7> kColours{"#000000",  kSkyBlue, kGreen, kGrey,
                                                   kVermilion, kBlue,    kPurple};
constexpr std::array<int, 7> kMarks{3, 7, 5, 9, 11, 13, 15};

// CVODE as it restarts at jumps; as it goes on it is in the table.
std::span<const std::string_view> drawn() { return std::span(contestant_names()).first(kColours.size()); }

// The most telling first: plain, ringing, stiff, rough.
std::vector<const Problem*> chosen_panels(const std::vector<Entry>& entries) {
    constexpr std::array<std::string_view, 4> kTelling{"insert_100mm_s", "underdamped", "wall", "quantised"};
    std::vector<const Problem*> all = problems_of(entries);
    std::vector<const Problem*> panels;
    for (const std::string_view name : kTelling) {
        const auto found =
            std::find_if(all.begin(), all.end(), [&](const Problem* p) { return p->name == name; });
        if (found == all.end()) continue;
        panels.push_back(*found);
        all.erase(found);
    }
    while (panels.size() < kTelling.size() && !all.empty()) {
        panels.push_back(all.front());
        all.erase(all.begin());
    }
    return panels;
}

// One block per panel and solver, in this order.
std::string figure_data(const std::vector<Entry>& entries, const std::vector<const Problem*>& panels) {
    std::string data;
    for (const Problem* problem : panels) {
        for (const std::string_view solver : drawn()) {
            data += fmt::format("# {} {}: position error (m), cost (ns per simulated ms)\n", problem->name,
                                solver);
            bool any = false;
            for (const Entry& e : entries) {
                if (e.problem != problem || e.contestant.solver != solver || !e.finished()) continue;
                write_cell(data, std::max(e.accuracy.position_m, kLeastError_m));
                write_cell(data, e.cost.least_ns_per_ms);
                data += "\n";
                any = true;
            }
            data += any ? "\n\n" : "NaN\tNaN\n\n\n";
        }
    }
    return data;
}

std::string curves(std::size_t panel) {
    std::string text = "plot ";
    for (std::size_t i = 0; i < drawn().size(); ++i) {
        text += fmt::format(
            "{}'{}.tsv' index {} using 1:2 with linespoints linewidth 1.4 pointtype {} pointsize {} "
            "linecolor '{}' notitle",
            i > 0 ? ", \\\n     " : "", kName, panel * drawn().size() + i, kMarks[i], i == 0 ? 1.6 : 0.7,
            kColours[i]);
    }
    return text + "\n";
}

std::string legend(int height_px) {
    std::string text = fmt::format(
        "unset border; unset tics; unset title; unset xlabel; unset ylabel\n"
        "set lmargin at screen 0.02; set rmargin at screen 0.98; set bmargin at screen "
        "{:.4f}; set tmargin at screen 0.995\nset key center center maxrows 2 textcolor "
        "'#222222'\nset xrange [0.1:1]; set yrange [0.1:1]\nplot ",
        1 - 1.0 * kLegend_px / height_px);
    for (std::size_t i = 0; i < drawn().size(); ++i) {
        text += fmt::format("{}NaN with linespoints linewidth 1.4 pointtype {} linecolor '{}' title '{}'",
                            i > 0 ? ", \\\n     " : "", kMarks[i], kColours[i], drawn()[i]);
    }
    return text + "\n";
}

std::string figure_script(const std::vector<const Problem*>& panels) {
    const std::size_t rows = (panels.size() + 1) / 2;
    const int height_px = kLegend_px + static_cast<int>(rows) * kPanelHeight_px;
    std::string script = gnuplot_preamble(kName, 2 * kPanelWidth_px, height_px);
    script +=
        "set termoption noenhanced\nset logscale xy\nset format x '1e%T'\nset format y '1e%T'\n"
        "set multiplot\n" +
        legend(height_px) +
        "unset key\nset border 3 linecolor '#444444'\nset tics nomirror out scale 0.6 textcolor "
        "'#222222'\nset xtics 1e-18, 1e3\nset ytics 10\nset xrange [1e-19:1]; set yrange [1:1e6]\n"
        "set grid linecolor '#dddddd'\n";
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const double left = i % 2 == 0 ? 0.075 : 0.565;
        const std::size_t row = i / 2;
        const double top_px = kLegend_px + static_cast<double>(row) * kPanelHeight_px;
        const auto from_bottom = [&](double y_px) { return 1 - y_px / height_px; };
        script += fmt::format(
            "set lmargin at screen {:.4f}; set rmargin at screen {:.4f}; set tmargin at screen "
            "{:.4f}; set bmargin at screen {:.4f}\n",
            left, left + 0.42, from_bottom(top_px + 30), from_bottom(top_px + kPanelHeight_px - 68));
        script += fmt::format(
            "set title '{}: {}' offset 0,-0.6\nset xlabel 'greatest position error (m)' offset 0,0.4\n"
            "set ylabel '{}' offset 1\n",
            panels[i]->name, panels[i]->about, i % 2 == 0 ? "ns per simulated ms" : "");
        script += curves(i);
    }
    return script + "unset multiplot\n";
}

}  // namespace

void draw_work_precision(const std::filesystem::path& directory, const std::vector<Entry>& entries) {
    const std::vector<const Problem*> panels = chosen_panels(entries);
    run_gnuplot(directory, kName, figure_data(entries, panels), figure_script(panels));
}

}  // namespace thimble
