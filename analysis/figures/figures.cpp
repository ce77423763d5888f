#include "analysis/figures/figures.hpp"

#include <algorithm>
#include <utility>

#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"

namespace thimble {

DrawnFigures draw_figures(const std::vector<FigureSource>& sources, const std::filesystem::path& output) {
    const std::filesystem::path directory = output / "figures";
    std::vector<GnuplotFiles> files;
    std::vector<std::string> names;
    for (const FigureSource& source : sources) {
        if (source.script.empty()) continue;
        files.push_back({source.name, source.data, source.script});
        names.push_back(source.name);
    }
    DrawnFigures drawn;
    if (names.empty()) return drawn;
    try {
        write_gnuplot_files(directory, files);
        drawn.problem = draw_with_gnuplot(directory, names).value_or("");
    } catch (const Error& error) {
        drawn.problem = error.what();
        return drawn;
    }
    for (const FigureSource& source : sources) {
        if (source.script.empty()) continue;
        std::optional<std::string> svg = drawn_svg(directory, source.name);
        if (!svg) continue;
        drawn.figures.push_back({source.name, source.title, source.caption, std::move(*svg)});
    }
    return drawn;
}

DrawnFigures draw_figures(const std::vector<TrajectoryPanel>& panels,
                          const std::vector<ConditionSummary>& conditions,
                          const std::filesystem::path& output, const std::string& suffix) {
    std::vector<FigureSource> sources;
    if (!panels.empty()) sources.push_back(trajectory_figure(panels, "trajectories" + suffix));
    if (!conditions.empty()) sources.push_back(bar_figure(conditions, "bars" + suffix));
    return draw_figures(sources, output);
}

}  // namespace thimble
