// Nanoseconds per step of a scene, against the number of its layers and for the scenes that come with the program.
//   build/release/bin/thimble-bench --benchmark_filter=scene
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "slave_sim/element_types.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace {

using namespace thimble;

struct Stroke {
    double low_m, high_m;
};

// Strokes in and out, so that they can be repeated without a jump.
void time_steps(benchmark::State& state, const SceneDeclaration& declaration, const Stroke& stroke) {
    std::array<double, 1000> needle_m{};
    for (std::size_t i = 0; i < needle_m.size(); ++i) {
        const double phase = 2 * std::numbers::pi * static_cast<double>(i) / needle_m.size();
        needle_m[i] = stroke.low_m + (stroke.high_m - stroke.low_m) * (0.5 - 0.5 * std::cos(phase));
    }
    NeedleScene scene(declaration, solver_maker({}), 256);
    scene.reset({needle_m[0], needle_m[0]});
    std::size_t step = 0;
    for (auto _ : state) {
        const double at_m = needle_m[step % needle_m.size()];
        scene.clear_transitions();
        scene.step(1e-3 * static_cast<double>(step++), 1e-3, {at_m, at_m});
        benchmark::DoNotOptimize(scene.force_tissue_N() + scene.force_fixture_N());
    }
}

void scene_layers(benchmark::State& state) {
    SceneDeclaration scene = read_scene(ConfigFile::parse("", "layers"), "layers");
    for (int i = 0; i < state.range(0); ++i) {
        TissueParameters layer;
        layer.rest_position_m = 0.02 + 0.0005 * i;
        scene.elements.push_back(declare_tissue(fmt::format("tissue{}", i + 1), layer));
    }
    time_steps(state, scene, state.range(1) != 0 ? Stroke{0.10, 0.12} : Stroke{0, 0.015});
}
BENCHMARK(scene_layers)->ArgNames({"layers", "awake"})->ArgsProduct({{0, 1, 2, 4, 8, 16, 32, 64}, {0, 1}});

void scene_built_in(benchmark::State& state) {
    const BuiltInScene& scene = built_in_scenes()[static_cast<std::size_t>(state.range(0))];
    time_steps(state,
               read_scene(ConfigFile::parse(std::string(scene.text), std::string(scene.name)), scene.name),
               {0, state.range(1) != 0 ? 0.13 : 0.015});
    state.SetLabel(std::string(scene.name));
}
BENCHMARK(scene_built_in)->ArgNames({"scene", "through"})->Apply([](auto* benchmark) {
    for (std::size_t i = 0; i < built_in_scenes().size(); ++i)
        benchmark->Args({static_cast<std::int64_t>(i), 0})->Args({static_cast<std::int64_t>(i), 1});
});

}  // namespace
