#include "bench/velocity/velocity_report.hpp"

#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>

#include "analysis/text/gnuplot.hpp"
#include "common/csv/csv.hpp"

namespace thimble {
namespace {

std::string name_of(const VelocityRow& row) {
    const std::string name = row.setting.empty() ? row.method : fmt::format("{} {}", row.method, row.setting);
    return row.is_default ? fmt::format("**{}**", name) : name;
}

std::string cell(double value, int digits) {
    return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits);
}

std::string line_of(const std::vector<std::string>& cells) {
    std::string line;
    for (const std::string& text : cells) line += fmt::format("| {} ", text);
    return line + "|\n";
}

std::string heading(const std::vector<std::string>& cells) {
    std::string rule;
    for (std::size_t i = 0; i < cells.size(); ++i) rule += i == 0 ? "| --- " : "| ---: ";
    return line_of(cells) + rule + "|\n";
}

// One line of the figure: the rows whose setting begins with `prefix`; labels on the side that has room.
struct Series {
    std::string_view method, prefix, colour, label_side;
};
constexpr std::array kSeries{Series{"raw", "", kGrey, "left offset 0.7,0"},
                             Series{"low_pass", "", kBlue, "left offset 0.3,0.6"},
                             Series{"windowed", "", kVermilion, "left offset 0.5,0.4"},
                             Series{"foaw", "best", kGreen, "left offset 0.7,-0.3"},
                             Series{"foaw", "end", kSkyBlue, "left offset 0.7,0.1"},
                             Series{"kalman", "", kPurple, "right offset -0.5,-0.6"}};

}  // namespace

std::string velocity_table(const std::vector<VelocityRow>& rows) {
    std::string text =
        heading({"estimator", "noise rms, mm/s", "noise peak, mm/s", "lag, ms", "phase lag at 10 Hz, deg",
                 "gain at 10 Hz", "error rms, mm/s", "without lag, mm/s", "cost, ns"});
    for (const VelocityRow& r : rows) {
        text += line_of({name_of(r), cell(1e3 * r.quality.noise_rms_m_per_s, 2),
                         cell(1e3 * r.quality.noise_peak_m_per_s, 1), cell(1e3 * r.quality.lag_s, 1),
                         cell(r.tremor.phase_lag_rad * 180 / std::numbers::pi, 0), cell(r.tremor.gain, 2),
                         cell(1e3 * r.quality.error_rms_m_per_s, 2),
                         cell(1e3 * r.quality.residual_rms_m_per_s, 2), cell(1e9 * r.cost_s, 0)});
    }
    text += '\n';
    text += heading({"estimator", "false punctures", "depth error mean, mm", "worst, mm", "entry late by, mm",
                     "transitions at entry", "contact force noise, mN", "penetrated force noise, mN",
                     "fixture damping noise, mN", "damping kept at 10 Hz", "added stiffness, N/m"});
    for (const VelocityRow& r : rows) {
        text += line_of({name_of(r), fmt::format("{} of {}", r.press.false_punctures, r.press.presses),
                         cell(1e3 * r.press.depth_error_mean_m, 1),
                         cell(1e3 * r.press.depth_error_worst_m, 1), cell(1e3 * r.entry.depth_error_m, 2),
                         cell(r.entry.transitions, 1), cell(1e3 * r.press.contact_force_noise_N, 1),
                         cell(1e3 * r.entry.force_noise_N, 1), cell(1e3 * r.fixture.damping_noise_N, 1),
                         cell(r.fixture.damping_kept, 2), cell(r.fixture.added_stiffness_N_per_m, 0)});
    }
    return text;
}

std::string velocity_csv(const std::vector<VelocityRow>& rows) {
    std::string text =
        "method,setting,noise_rms_m_per_s,noise_peak_m_per_s,lag_s,residual_rms_m_per_s,error_rms_m_per_s,"
        "tremor_gain,tremor_phase_lag_rad,tremor_noise_rms_m_per_s,presses,false_punctures,"
        "press_ideal_depth_m,press_depth_error_mean_m,press_depth_error_worst_m,contact_force_noise_N,"
        "entry_depth_error_m,entry_transitions,entry_ideal_transitions,penetrated_force_noise_N,"
        "fixture_damping_noise_N,fixture_damping_kept,fixture_added_stiffness_N_per_m\n";
    for (const VelocityRow& r : rows) {
        text += fmt::format("{},{}", r.method, r.setting);
        for (const double value : {r.quality.noise_rms_m_per_s,
                                   r.quality.noise_peak_m_per_s,
                                   r.quality.lag_s,
                                   r.quality.residual_rms_m_per_s,
                                   r.quality.error_rms_m_per_s,
                                   r.tremor.gain,
                                   r.tremor.phase_lag_rad,
                                   r.tremor.noise_rms_m_per_s,
                                   static_cast<double>(r.press.presses),
                                   static_cast<double>(r.press.false_punctures),
                                   r.press.ideal_depth_m,
                                   r.press.depth_error_mean_m,
                                   r.press.depth_error_worst_m,
                                   r.press.contact_force_noise_N,
                                   r.entry.depth_error_m,
                                   r.entry.transitions,
                                   r.entry.ideal_transitions,
                                   r.entry.force_noise_N,
                                   r.fixture.damping_noise_N,
                                   r.fixture.damping_kept,
                                   r.fixture.added_stiffness_N_per_m}) {
            text += ',';
            write_number(std::back_inserter(text), value);
        }
        text += '\n';
    }
    return text;
}

void draw_velocity_figure(const std::vector<VelocityRow>& rows, const std::filesystem::path& directory) {
    const std::string name = "velocity";
    std::string data =
        "# lag_ms, noise_mm_per_s, setting; a block per line of the figure, the default last\n";
    std::string defaults;
    std::string script = gnuplot_preamble(name, 760, 500);
    script += R"(set xlabel 'lag on the reach, ms'; set ylabel 'noise of a steady motion, rms, mm/s'
set logscale xy; set xrange [0.4:40]; set yrange [0.05:20]
set xtics (0.5, 1, 2, 5, 10, 20, 40); set ytics (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20)
set key top right samplen 1.2 noenhanced
set datafile separator tab
plot )";
    for (std::size_t i = 0; i < kSeries.size(); ++i) {
        const Series& series = kSeries[i];
        for (const VelocityRow& r : rows) {
            if (r.method != series.method || !r.setting.starts_with(series.prefix)) continue;
            std::string point;
            write_cell(point, 1e3 * r.quality.lag_s);
            write_cell(point, 1e3 * r.quality.noise_rms_m_per_s);
            point += r.setting.substr(series.prefix.size());
            point += '\n';
            data += point;
            if (r.is_default) defaults += point;
        }
        data += "\n\n";
        script += fmt::format(
            "'{0}.tsv' index {1} using 1:2 with linespoints pointtype 7 pointsize 0.7 linecolor '{2}' title "
            "'{3}', '' index {1} using 1:2:3 with labels {4} font ',10' textcolor '{2}' noenhanced "
            "notitle, \\\n     ",
            name, i, series.colour, fmt::format("{} {}", series.method, series.prefix), series.label_side);
    }
    script += fmt::format(
        "'{}.tsv' index {} using 1:2 with points pointtype 6 pointsize 2 linewidth 2 linecolor '#222222' "
        "title 'the default'\n",
        name, kSeries.size());
    run_gnuplot(directory, name, data + defaults, script);
}

}  // namespace thimble
