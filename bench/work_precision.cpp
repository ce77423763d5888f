// thimble-bench work-precision: what each tissue solver costs for which error (docs/speed.md).
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "analysis/text/gnuplot.hpp"
#include "bench/solver_sweep.hpp"
#include "bench/studies.hpp"
#include "common/csv/csv.hpp"
#include "common/csv/csv_file.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/command_line.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

using Sweep = std::vector<SolverRun>;

constexpr double kEqualError_m = 1e-9;                           // at which solvers are compared
constexpr auto kFamilies = std::span(kSweptSolvers).first<7>();  // in tables `_on` counts as the same solver
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kFigure = "work_precision";

void write_runs(CsvFile& file, const Sweep& runs) {
    for (const SolverRun& r : runs) {
        std::string line = fmt::format("{},{},{}", r.problem->name, r.solver, r.outcome);
        const auto add = [&](double value) { write_number(std::back_inserter(line += ','), value); };
        add(r.step_s);
        add(r.tolerance);
        const Accuracy& a = r.accuracy;
        for (const double value :
             {a.position_m, a.velocity_m_per_s, a.force_N, a.event_time_s, r.least_ns_per_ms})
            add(r.finished() ? value : kUnknown);
        file.write(line + '\n');
    }
}

std::string exact_row(const Sweep& runs) {
    const SolverRun& r = runs.front();
    const Accuracy& a = r.accuracy;
    return fmt::format("| `{}` | {} | {:.0e} | {:.0e} | {:.0e} | {:.0e} | {:.2g} |\n", r.problem->name,
                       r.problem->about, a.position_m, a.velocity_m_per_s, a.force_N, a.event_time_s,
                       r.least_ns_per_ms * r.problem->step_s * 1e3);
}

// The cheapest setting of a family that reaches the error with the right events; infinite if none does.
double cheapest_ns_per_ms(const Sweep& runs, std::string_view family) {
    double least = std::numeric_limits<double>::infinity();
    for (const SolverRun& r : runs) {
        if (r.outcome == "ok" && r.solver.starts_with(family) && r.accuracy.position_m <= kEqualError_m)
            least = std::min(least, r.least_ns_per_ms);
    }
    return least;
}

std::string equal_error_row(const Sweep& runs) {
    const double exact_ns = runs.front().least_ns_per_ms;
    std::string row = fmt::format("| `{}` | {:.2g} |", runs.front().problem->name, exact_ns);
    for (const std::string_view family : kFamilies.subspan<1>()) {
        const double ratio = cheapest_ns_per_ms(runs, family) / exact_ns;
        row += std::isfinite(ratio) ? fmt::format(" {:.3g} |", ratio) : " - |";
    }
    return row + '\n';
}

void print_tables(const std::vector<Sweep>& sweeps) {
    fmt::print(
        "| problem | needle or tissue | position, m | velocity, m/s | force, N | event time, s | ns per step "
        "|\n"
        "| --- | --- | ---: | ---: | ---: | ---: | ---: |\n");
    for (const Sweep& runs : sweeps) fmt::print("{}", exact_row(runs));
    fmt::print("\n| position error of at most {:g} m: cost over exact's | exact, ns per ms |", kEqualError_m);
    for (const std::string_view family : kFamilies.subspan<1>()) fmt::print(" {} |", family);
    fmt::print("\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    for (const Sweep& runs : sweeps) fmt::print("{}", equal_error_row(runs));
}

// One block per problem and solver, in this order.
std::string figure_data(const std::vector<Sweep>& panels) {
    constexpr double kLeastError_m = 1e-19;  // an error of nothing has no place on a logarithmic axis
    std::string data;
    for (const Sweep& runs : panels) {
        for (const std::string_view solver : kFamilies) {
            for (const SolverRun& r : runs) {
                if (r.solver != solver || !r.finished()) continue;
                write_cell(data, std::max(r.accuracy.position_m, kLeastError_m));
                write_cell(data, r.least_ns_per_ms);
                data += '\n';
            }
            data += "NaN\tNaN\n\n\n";
        }
    }
    return data;
}

std::string panel_script(std::size_t panel, const Problem& problem) {
    constexpr std::array<Colour, kFamilies.size()> kColours{kBlack,      kSkyBlue, kBluishGreen,  kGrey,
                                                            kVermillion, kBlue,    kReddishPurple};
    std::string script = fmt::format("set title '{}: {}'\nplot ", problem.name, problem.about);
    for (std::size_t i = 0; i < kFamilies.size(); ++i) {
        script += fmt::format(
            "{}'{}.tsv' index {} using 1:2 with linespoints linewidth 1.4 pointtype {} pointsize {} "
            "linecolor '{}' title '{}'",
            i > 0 ? ", \\\n     " : "", kFigure, panel * kFamilies.size() + i, 3 + 2 * i, i == 0 ? 1.6 : 0.7,
            kColours[i], kFamilies[i]);
    }
    return script + "\nunset key\n";  // the first panel's stands above all of them
}

// The most telling problems, as far as they were run: plain, ringing, stiff, rough.
void draw_figure(const std::filesystem::path& folder, std::vector<Sweep> panels) {
    constexpr std::array<std::string_view, 4> kTelling{"insert_100mm_s", "underdamped", "wall", "quantised"};
    std::erase_if(panels, [&](const Sweep& runs) {
        return std::find(kTelling.begin(), kTelling.end(), runs.front().problem->name) == kTelling.end();
    });
    if (panels.empty()) return;
    std::string script = gnuplot_preamble(kFigure, 1000, 870);
    script +=
        "set termoption noenhanced\nset logscale xy\nset format xy '1e%T'\nset xtics 1e-18, 1e3\nset ytics "
        "10\n"
        "set xrange [1e-19:1]; set yrange [1:1e6]\nset grid linecolor '#dddddd'\n"
        "set xlabel 'greatest position error (m)'\nset ylabel 'ns per simulated ms'\n"
        "set multiplot layout 2,2 margins 0.08,0.98,0.08,0.88 spacing 0.09,0.14\n"
        "set key at screen 0.5,0.99 center top Left reverse maxrows 2\n";
    for (std::size_t i = 0; i < panels.size(); ++i) script += panel_script(i, *panels[i].front().problem);
    run_gnuplot(folder, kFigure, figure_data(panels), script + "unset multiplot\n");
}

std::vector<Sweep> run_sweeps(const std::filesystem::path& folder, const std::vector<std::string>& names,
                              bool quick) {
    CsvFile file(folder / "work_precision.csv", IfExists::kReplace);
    file.write(
        "problem,solver,outcome,step_s,tolerance,position_error_m,velocity_error_m_per_s,force_error_N,event_"
        "time_error_s,cost_least_ns_per_ms\n");
    Progress progress;
    std::vector<Sweep> sweeps;
    for (const std::string& name : names) {
        progress.show(fmt::format("problem {} of {}: {}", sweeps.size() + 1, names.size(), name), true);
        sweeps.push_back(sweep_solvers(problem_named(name), quick));
        write_runs(file, sweeps.back());
    }
    file.flush();
    return sweeps;
}

}  // namespace

int work_precision_study(int argc, char** argv) {
    std::string out = "out/work-precision";
    std::vector<std::string> names;
    bool quick = false;
    CLI::App app("Speed against error of the tissue solvers, against a solution of 40 digits and more.",
                 "thimble-bench work-precision");
    app.add_option("-o,--out", out, "folder for work_precision.csv and the figure")->default_str(out);
    app.add_option("-p,--problem", names, "problems by name; all of them if none is given");
    app.add_flag("--quick", quick, "few settings and repetitions: does it run at all?");
    app.footer(
        "Example:\n  thimble-bench work-precision --problem insert_100mm_s underdamped --out "
        "out/work-precision\n\n"
        "Exit codes: 0 ok (whatever was measured), 1 failed, 2 usage.");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    for (const std::string& name : names) problem_named(name);
    if (names.empty()) {
        for (const Problem& problem : problems()) names.emplace_back(problem.name);
    }
    make_folder(out);
    std::vector<Sweep> sweeps = run_sweeps(out, names, quick);
    print_tables(sweeps);
    draw_figure(out, std::move(sweeps));
    return 0;
}

}  // namespace thimble
