// Scenes, solvers and needles for property tests, drawn with RapidCheck.
#pragma once

#include <string>
#include <vector>

#include "slave_sim/needle_scene.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {

// The text of a scene file: up to four layers and a vessel, fixtures that change, guidance.
std::string random_scene();

struct RandomSolver {
    std::string name;
    double step_s;
    TissueMaker make;
};

// One that can step every tissue of the scene; hard tissue leaves two.
RandomSolver random_solver(const SceneDeclaration& scene);

struct RandomStep {
    double duration_s;
    NeedleSample needle;
};

// Strokes, holds and tremor about the elements, in steps from 1 us to 2 s; some needles are quantised, and many
// stand on a surface to the last bit.
std::vector<RandomStep> random_needle(const SceneDeclaration& scene);

}  // namespace thimble
