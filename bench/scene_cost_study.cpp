// The cost of a scene: nanoseconds per step against the number of layers, asleep and awake, with and without
// fixtures, and for each scene that comes with the program.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "analysis/text/gnuplot.hpp"
#include "bench/studies.hpp"
#include "common/csv/csv_file.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "slave_sim/elements/tissue_table.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {

namespace {

constexpr double kStepSeconds = 1e-3;
constexpr std::size_t kStroke = 1000;  // steps of one stroke of the needle

struct Case {
    std::string scene;
    std::string needle;  // "above all", "beneath all", "through all"
    std::size_t layers = 0;
    SceneDeclaration declaration;
    double low_m, high_m;               // of the needle's stroke
    std::size_t awake = 0;              // elements, while it was timed
    std::vector<double> ns_per_step{};  // one value per repetition
};

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

double least(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }

SceneDeclaration stack(std::size_t layers, const char* fixture_text) {
    SceneDeclaration scene = read_scene(ConfigFile::parse(fixture_text, "stack"), "stack");
    for (std::size_t i = 0; i < layers; ++i) {
        TissueParameters p;
        p.rest_position_m = 0.02 + 0.0005 * static_cast<double>(i);
        scene.elements.push_back(declare_tissue(fmt::format("tissue{}", i + 1), p));
    }
    return scene;
}

std::vector<Case> make_cases() {
    std::vector<Case> cases;
    constexpr const char* kNone = "";
    constexpr const char* kDeep = "[fixture]\nposition_m = 0.5\n";
    for (const std::size_t layers : {0, 1, 2, 4, 8, 16, 32, 64}) {
        cases.push_back({"layers", "above all", layers, stack(layers, kNone), 0.0, 0.015});
        cases.push_back({"layers", "beneath all", layers, stack(layers, kNone), 0.10, 0.12});
    }
    cases.push_back({"layer and fixture", "above all", 1, stack(1, kDeep), 0.0, 0.015});
    cases.push_back({"layer and fixture", "beneath all", 1, stack(1, kDeep), 0.10, 0.12});
    cases.push_back({"layer and fixture", "beyond the fixture", 1, stack(1, kDeep), 0.51, 0.52});
    for (const BuiltInScene& scene : built_in_scenes()) {
        const SceneDeclaration declared = read_scene(ConfigFile::parse(scene.text, scene.name), scene.name);
        const auto layers = static_cast<std::size_t>(
            std::count_if(declared.elements.begin(), declared.elements.end(),
                          [](const ElementDeclaration& e) { return e.kind == ElementKind::kTissue; }));
        cases.push_back({std::string(scene.name), "above all", layers, declared, 0.0, 0.015});
        cases.push_back({std::string(scene.name), "through all", layers, declared, 0.0, 0.13});
    }
    return cases;
}

// One stroke in and out, so that it can be repeated without a jump.
std::vector<double> stroke(const Case& c) {
    std::vector<double> needle_m(kStroke);
    for (std::size_t i = 0; i < kStroke; ++i) {
        const double phase = 2 * std::numbers::pi * static_cast<double>(i) / kStroke;
        needle_m[i] = c.low_m + (c.high_m - c.low_m) * (0.5 - 0.5 * std::cos(phase));
    }
    return needle_m;
}

double run(NeedleScene& scene, const std::vector<double>& needle_m, std::size_t steps) {
    double time_s = 0;
    std::size_t at = 0;
    const SessionTime begin = wall_now();
    for (std::size_t i = 0; i < steps; ++i) {
        scene.clear_transitions();
        scene.step(time_s, kStepSeconds, {needle_m[at], needle_m[at]});
        benchmark::DoNotOptimize(scene.force_tissue_N() + scene.force_fixture_N());
        time_s += kStepSeconds;
        at = at + 1 == kStroke ? 0 : at + 1;
    }
    return static_cast<double>((wall_now() - begin).count()) / static_cast<double>(steps);
}

// Repetitions are interleaved, so that a busy moment of the machine meets every case alike.
void measure(std::vector<Case>& cases, int repetitions, std::size_t steps) {
    std::vector<NeedleScene> scenes;
    std::vector<std::vector<double>> needles;
    for (const Case& c : cases) {
        scenes.emplace_back(c.declaration, solver_maker({}), std::size_t{256});
        needles.push_back(stroke(c));
        scenes.back().reset({needles.back()[0], needles.back()[0]});
        run(scenes.back(), needles.back(), kStroke);
    }
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        fmt::print(stderr, "repetition {} of {}\n", repetition + 1, repetitions);
        for (std::size_t i = 0; i < cases.size(); ++i) {
            cases[i].ns_per_step.push_back(run(scenes[i], needles[i], steps));
            cases[i].awake = scenes[i].awake();
        }
    }
}

void write_csv(const std::filesystem::path& path, const std::vector<Case>& cases) {
    CsvFile file(path, IfExists::kReplace);
    file.write("scene,needle,layers,elements_awake,cost_min_ns_per_step,cost_median_ns_per_step\n");
    for (const Case& c : cases) {
        file.write(fmt::format("{},{},{},{},{:.2f},{:.2f}\n", c.scene, c.needle, c.layers, c.awake,
                               least(c.ns_per_step), median(c.ns_per_step)));
    }
}

void print_table(const std::vector<Case>& cases) {
    fmt::print("{:<20} {:<19} {:>6} {:>6} {:>12} {:>15}\n", "scene", "needle", "layers", "awake",
               "least ns/step", "median ns/step");
    for (const Case& c : cases) {
        fmt::print("{:<20} {:<19} {:>6} {:>6} {:>12.1f} {:>15.1f}\n", c.scene, c.needle, c.layers, c.awake,
                   least(c.ns_per_step), median(c.ns_per_step));
    }
}

void draw(const std::filesystem::path& folder, const std::vector<Case>& cases) {
    std::string data;
    for (const char* needle : {"above all", "beneath all"}) {
        for (const Case& c : cases) {
            if (c.scene != "layers" || c.needle != needle) continue;
            write_cell(data, static_cast<double>(c.layers));
            write_cell(data, least(c.ns_per_step));  // a busy machine only ever adds
            data += '\n';
        }
        data += "\n\n";
    }
    std::string script = gnuplot_preamble("scene_cost", 640, 400);
    script += fmt::format(
        "set xlabel 'tissue layers'\nset ylabel 'least cost (ns per step)'\nset yrange [0:*]\nset key left "
        "top\n"
        "plot 'scene_cost.tsv' index 0 using 1:2 with linespoints lc rgb '{}' pt 7 title 'asleep: needle "
        "above', "
        "'' index 1 using 1:2 with linespoints lc rgb '{}' pt 5 title 'awake: needle beneath'\n",
        kBlue, kVermilion);
    run_gnuplot(folder, "scene_cost", data, script);
}

}  // namespace

int scene_cost_study(int argc, char** argv) {
    std::string out = "out/scene-cost";
    bool quick = false;
    CLI::App app("Nanoseconds per step of a scene against the number of layers, asleep and awake.",
                 "thimble-bench scene-cost");
    app.add_option("-o,--out", out, "folder for scene_cost.csv and the figure")->capture_default_str();
    app.add_flag("--quick", quick, "few steps: shows that it runs, the figures mean little");
    app.footer("Example:\n  thimble-bench scene-cost --out out/scene-cost");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    make_folder(out);
    std::vector<Case> cases = make_cases();
    measure(cases, quick ? 1 : 15, quick ? kStroke : 200 * kStroke);
    write_csv(std::filesystem::path(out) / "scene_cost.csv", cases);
    print_table(cases);
    draw(out, cases);
    return 0;
}

}  // namespace thimble
