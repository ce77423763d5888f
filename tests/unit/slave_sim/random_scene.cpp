#include "tests/unit/slave_sim/random_scene.hpp"

#include <cmath>

#include <fmt/format.h>

#include "common/error.hpp"
#include "tests/unit/slave_sim/random_values.hpp"

namespace thimble {

namespace {

bool chance(double probability) { return between(0, 1) < probability; }

// One in three is hard: nearly massless, heavy or stiff, a drag of nothing or much.
std::string random_tissue_keys() {
    const bool hard = chance(0.3);
    const double mass_kg = hard ? decade(-12, 6) : decade(-2, 1);
    const double stiffness = chance(0.1) ? 0 : hard ? decade(-3, 6) : decade(-1, 2);
    const double damping = chance(0.1) ? 0 : hard ? decade(-3, 3) : decade(-1, 1);
    const double drag = chance(0.1) ? 0 : hard ? decade(-6, 2) : decade(-2, 0.5);
    return fmt::format(
        "mass_kg = {:e}\nstiffness_N_per_m = {:e}\ndamping_Ns_per_m = {:e}\ndrag_Ns_per_m = {:e}\n"
        "puncture_force_N = {:e}\nrest_position_m = {:.17f}\n",
        mass_kg, stiffness, damping, drag, decade(-3, 1), between(0, 0.08));
}

std::string random_event() {
    const char* trigger = chance(0.5) ? "time_s" : "after_contact_s";
    std::string text = fmt::format("[[fixture.event]]\n{} = {:e}\n", trigger, decade(-3, 1));
    if (chance(0.5)) text += fmt::format("position_m = {:.17f}\n", between(0, 0.1));
    return text;
}

std::string random_fixture() {
    std::string text =
        fmt::format("[[fixture]]\nstiffness_N_per_m = {:e}\ndamping_Ns_per_m = {:e}\nposition_m = {:.17f}\n",
                    decade(2, 9), chance(0.5) ? 0 : decade(-1, 3), between(0, 0.1));
    for (double events = between(-1, 3.99); events >= 1; --events) text += random_event();
    return text;
}

}  // namespace

std::string random_scene() {
    std::string text;
    for (double layers = between(0, 4.99); layers >= 1; --layers)
        text += "[[tissue]]\n" + random_tissue_keys();
    if (chance(0.3)) {
        text += fmt::format("[vessel]\ndiameter_m = {:.17f}\n", between(0, 0.01)) + random_tissue_keys();
    }
    for (double fixtures = between(0, 2.99); fixtures >= 1; --fixtures) text += random_fixture();
    if (chance(0.3)) {
        text += fmt::format("[guidance]\nstiffness_N_per_m = {:e}\ndamping_Ns_per_m = {:e}\n", decade(0, 4),
                            chance(0.5) ? 0 : decade(-1, 2));
    }
    return text;
}

RandomSolver random_solver(const SceneDeclaration& scene) {
    const double step_s = decade(-3.3, -1);
    const auto index = static_cast<std::size_t>(between(0, 3.999));
    for (const std::string_view name : {kSolverNames[index], kSolverNames[3]}) {
        const TissueMaker make = solver_maker({name, step_s});
        try {
            NeedleScene(scene, make);
            return {std::string(name), step_s, make};
        } catch (const Error&) {
            // An explicit rule that would be unstable: the implicit one never is.
        }
    }
    RC_FAIL("implicit_midpoint refused a tissue");
}

std::vector<RandomStep> random_needle(const SceneDeclaration& scene) {
    const double quantum_m = chance(0.3) ? 3e-5 : 0;
    std::vector<RandomStep> steps;
    double needle_m = between(-0.02, 0.02);
    for (int i = 0; i < 60; ++i) {
        const double kind = between(0, 1);
        if (kind < 0.4) needle_m += between(-0.01, 0.01);
        if (kind > 0.4 && kind < 0.5) needle_m += between(-1e-6, 1e-6);
        if (kind > 0.7) needle_m = between(-0.02, 0.12);
        if (quantum_m > 0) needle_m = quantum_m * std::round(needle_m / quantum_m);
        if (kind > 0.9 && !scene.elements.empty()) {
            const double place = between(0, static_cast<double>(scene.elements.size()) - 1e-9);
            needle_m = scene.elements[static_cast<std::size_t>(place)].position_m;
        }
        const double reading_m = chance(0.7) ? needle_m : needle_m + between(-1e-4, 1e-4);
        steps.push_back({decade(-6, 0.3), {needle_m, reading_m}});
    }
    return steps;
}

}  // namespace thimble
