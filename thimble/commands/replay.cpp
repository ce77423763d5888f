#include "thimble/commands/replay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {

namespace {

std::filesystem::path events_beside(std::filesystem::path out) {
    if (out.extension() == ".csv") return out.replace_extension(".events.csv");
    return out += ".events.csv";
}

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code error;
    return std::filesystem::weakly_canonical(a, error) == std::filesystem::weakly_canonical(b, error);
}

void refuse_overwriting(const ReplayOptions& options, const std::filesystem::path& events) {
    const auto differ = [](const std::filesystem::path& a, const std::filesystem::path& b) {
        if (same_file(a, b)) {
            throw Error(
                ExitCode::kUsage,
                fmt::format("{} is named twice: needle, output and events must be three files", a.string()));
        }
    };
    differ(options.needle, options.out);
    differ(options.needle, events);
    differ(options.out, events);
}

// Of every layer, not only the outermost: a needle cannot begin in the middle of a wall either.
void refuse_start_inside(const SceneDeclaration& scene, const ReplayOptions& options,
                         const NeedlePath::Sample& first) {
    for (const ElementDeclaration& element : scene.elements) {
        if (element.kind != ElementKind::kTissue || first.position_m <= element.position_m) continue;
        throw Error(ExitCode::kData, fmt::format("{}:{}: the needle starts at {} m, inside '{}' whose "
                                                 "surface is at {} m: start the recording outside the tissue",
                                                 options.needle.string(), first.line, first.position_m,
                                                 element.name, element.position_m));
    }
}

void write_sample(CsvFile& out, double time_s, const NeedleScene& scene) {
    TissueState surface;
    surface.position_surface_m = surface.velocity_surface_m_per_s = std::numeric_limits<double>::quiet_NaN();
    if (scene.surface() != nullptr) surface = scene.surface()->state();
    const double tissue_N = scene.force_tissue_N();
    const double fixture_N = scene.force_fixture_N();
    out.write(fmt::format("{:.17g},{:.17g},{:.17g},{:.17g},{},{:.17g},{:.17g},{:.17g}\n", time_s,
                          scene.needle().position_m, surface.position_surface_m,
                          surface.velocity_surface_m_per_s,
                          scene.surface() != nullptr ? to_string(surface.phase) : "none", tissue_N, fixture_N,
                          tissue_N + fixture_N));
}

// Elements report one after the other; the list is in the order of time.
void write_transitions(CsvFile& events, double start_s, const NeedleScene& scene,
                       std::vector<Transition>& scratch) {
    const Transitions& transitions = scene.transitions();
    scratch.assign(transitions.begin(), transitions.end());
    std::stable_sort(scratch.begin(), scratch.end(),
                     [](const Transition& a, const Transition& b) { return a.offset_s < b.offset_s; });
    for (const Transition& t : scratch) {
        events.write(
            fmt::format("{:.17g},{},{}\n", start_s + t.offset_s, scene.element_name(t.element), t.phase));
    }
}

ReplayResult walk(const NeedlePath& path, NeedleScene& scene, CsvFile& out, CsvFile& events,
                  const std::atomic<bool>* stop) {
    ReplayResult result;
    std::vector<Transition> scratch;
    double before_s = path.samples.front().time_s;
    scene.reset({path.samples.front().position_m, path.samples.front().position_m});
    for (const NeedlePath::Sample& sample : path.samples) {
        if (stop != nullptr && stop->load()) {
            result.complete = false;
            break;
        }
        scene.clear_transitions();
        scene.step(before_s, sample.time_s - before_s, {sample.position_m, sample.position_m});
        write_sample(out, sample.time_s, scene);
        if (scene.transitions().size() > 0) write_transitions(events, before_s, scene, scratch);
        before_s = sample.time_s;
        ++result.samples;
        result.transitions += scene.transitions().size();
        result.force_peak_N =
            std::max(result.force_peak_N, std::abs(scene.force_tissue_N() + scene.force_fixture_N()));
    }
    result.duration_s = before_s - path.samples.front().time_s;
    return result;
}

}  // namespace

ReplayResult replay(const ReplayOptions& options) {
    const std::filesystem::path events_path =
        options.events.empty() ? events_beside(options.out) : options.events;
    refuse_overwriting(options, events_path);
    const SceneDeclaration declaration = load_scene(options.scene);
    NeedleScene scene(declaration, solver_maker({options.solver, options.solver_step_s}),
                      Transitions::kUnlimited);
    const NeedlePath path = read_needle_path(options.needle, options.limits);
    refuse_start_inside(declaration, options, path.samples.front());
    CsvFile out(options.out, IfExists::kReplace), events(events_path, IfExists::kReplace);
    out.write(
        "time_s,position_needle_m,position_tissue_m,velocity_tissue_m_per_s,tissue_phase,"
        "force_tissue_N,force_fixture_N,force_total_N\n");
    events.write("time_s,element,phase\n");
    ReplayResult result = walk(path, scene, out, events, options.stop);
    out.flush();
    events.flush();
    result.events = events_path;
    return result;
}

}  // namespace thimble
