#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "common/error.hpp"
#include "slave_sim/exact_tissue.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostTransitions = 16;  // kept per step, as in a session
// In a step and by one element, kept or not: each transition costs `exact` an evaluation.
constexpr std::uint64_t kMostPerElement = ExactTissue::kMostEvaluations;

struct Stop {
    double position_m;
    double parts;  // of the longest step of a rule, on the way there
};

// The way has stops at the first few elements only. It leads through the others without a stop.
std::vector<double> depths_of(const SceneDeclaration& declaration) {
    constexpr std::size_t kMostDepths = 6;
    std::set<double> depths_m;
    for (const ElementDeclaration& element : declaration.elements) {
        if (depths_m.size() < kMostDepths) depths_m.insert(element.position_m);
    }
    return {depths_m.begin(), depths_m.end()};
}

// From above everything a scene can hold to beneath it and back: at each depth touching, pressing, passing and
// waiting.
std::vector<Stop> way_through(const SceneDeclaration& declaration) {
    constexpr double kHighest_m = -1.1;
    constexpr double kDeepest_m = 2.1;  // a vessel's far wall can lie at 2 m
    std::vector<Stop> way{{kHighest_m, 1}};
    const std::vector<double> depths_m = depths_of(declaration);
    for (const double depth_m : depths_m) {
        for (const Stop& stop : {Stop{-1e-4, 1}, {0, 1}, {1e-7, 1.5}, {1e-3, 1}, {0.02, 2}, {0.02, 3}}) {
            way.push_back({depth_m + stop.position_m, stop.parts});
        }
    }
    way.push_back({kDeepest_m, 1});
    way.push_back({kDeepest_m, 2});
    for (auto depth = depths_m.rbegin(); depth != depths_m.rend(); ++depth) {
        for (const Stop& stop : {Stop{1e-4, 2}, {-1e-6, 1}, {-1e-4, 1}, {-1e-4, 3}}) {
            way.push_back({*depth + stop.position_m, stop.parts});
        }
    }
    way.push_back({kHighest_m, 1});
    return way;
}

std::string flaw_of_transitions(const NeedleScene& scene, std::size_t elements, double duration_s) {
    const Transitions& transitions = scene.transitions();
    if (transitions.size() > kMostTransitions) return "more transitions than were asked for";
    const Transition* before = nullptr;
    for (const Transition& t : transitions) {
        if (!(t.offset_s >= 0 && t.offset_s <= duration_s)) return "a transition outside of its step";
        if (t.element >= elements || t.phase.empty()) return "a transition of nothing";
        if (before != nullptr && t.element < before->element) return "elements out of order";
        if (before != nullptr && t.element == before->element && t.offset_s < before->offset_s) {
            return "transitions out of order";
        }
        before = &t;
    }
    return "";
}

std::string flaw_of_state(const NeedleScene& scene, std::size_t elements) {
    if (!std::isfinite(scene.force_tissue_N())) return "a force of tissue that is not finite";
    if (!std::isfinite(scene.force_fixture_N())) return "a force of fixtures that is not finite";
    if (scene.awake() > elements) return "more awake than there are";
    if (const TissueSolver* surface = scene.surface()) {
        const TissueState state = surface->state();
        if (!std::isfinite(state.position_surface_m)) return "a surface that is nowhere";
        if (!std::isfinite(state.velocity_surface_m_per_s)) return "a surface whose velocity is not finite";
    }
    if (const ForbiddenRegion* fixture = scene.fixture(); fixture != nullptr && fixture->force_N() > 0) {
        return "a fixture that pulls";
    }
    return "";
}

std::string walk(NeedleScene scene, const SceneDeclaration& declaration, double unit_s) {
    const std::size_t elements = declaration.elements.size();
    const std::vector<Stop> way = way_through(declaration);
    scene.reset({way.front().position_m, way.front().position_m});
    double now_s = 0;
    for (const Stop& stop : way) {
        const double duration_s = stop.parts * unit_s;
        const std::uint64_t overflows = scene.transitions().overflows();
        scene.clear_transitions();
        scene.step(now_s, duration_s, {stop.position_m, stop.position_m});
        std::string flaw = flaw_of_state(scene, elements);
        if (flaw.empty()) flaw = flaw_of_transitions(scene, elements, duration_s);
        if (scene.transitions().overflows() - overflows > elements * kMostPerElement) {
            flaw = "transitions without end";
        }
        if (!flaw.empty()) {
            return fmt::format("{} at {} m after {} s", flaw, stop.position_m, now_s + duration_s);
        }
        now_s += duration_s;
    }
    return "";
}

NeedleScene build(const SceneDeclaration& declaration, const SolverChoice& choice) {
    return {declaration, solver_maker(choice), kMostTransitions};
}

// A rule that refuses says which step it takes. Each layer has its own, so the next one can refuse again.
std::string walk_with(const SceneDeclaration& declaration, SolverChoice choice) {
    for (std::size_t refusals = 0; refusals <= declaration.elements.size(); ++refusals) {
        try {
            return walk(build(declaration, choice), declaration, choice.longest_step_s);
        } catch (const Error& error) {
            if (error.code() != ExitCode::kUsage) return "a refusal that is not about usage";
            const char* const advice = std::strstr(error.what(), "use at most ");
            double advised_s = 0;
            if (advice == nullptr || std::sscanf(advice, "use at most %lf s", &advised_s) != 1) {
                return fmt::format("a refusal without advice: {}", error.what());
            }
            if (!(advised_s > 0 && advised_s < choice.longest_step_s)) {
                return fmt::format("useless advice: {}", error.what());
            }
            choice.longest_step_s = advised_s;
        }
    }
    return fmt::format("{} refuses the steps that it advises", choice.name);
}

std::string flaw_of_names(const SceneDeclaration& declaration) {
    std::set<std::string_view> names;
    for (const ElementDeclaration& element : declaration.elements) {
        if (element.name.empty()) return "an element without a name";
        if (!names.insert(element.name).second) return fmt::format("two elements are named {}", element.name);
    }
    return "";
}

std::string flaw_of_scene(const SceneDeclaration& declaration) {
    std::string flaw = flaw_of_names(declaration);
    for (const double step_s : {1.0, 1e-3}) {  // whatever its length: a step of `exact` is one
        if (flaw.empty()) flaw = walk(build(declaration, {"exact", step_s}), declaration, step_s);
    }
    for (const std::string_view solver : kSolverNames) {
        if (flaw.empty() && solver != "exact") flaw = walk_with(declaration, {solver, 1e-3});
        if (!flaw.empty()) return fmt::format("{}: {}", solver, flaw);
    }
    return flaw;
}

}  // namespace

Verdict check_scene(Bytes bytes) {
    const std::string_view text = text_of(bytes);
    SceneDeclaration declaration;
    try {
        const ConfigFile file = ConfigFile::parse(text, "fuzz.toml");
        file.read_all([&] { declaration = read_scene(file, "fuzz.toml"); });
    } catch (const Error& error) {
        const std::string_view what = error.what();
        if (error.code() != ExitCode::kUsage) return {false, "an Error that is not about usage"};
        return {false, what.starts_with("fuzz.toml") ? "" : "an Error that does not name the file"};
    }
    try {
        return {true, flaw_of_scene(declaration)};
    } catch (const Error& error) {
        return {true, fmt::format("accepted, then refused: {}", error.what())};
    }
}

}  // namespace thimble
