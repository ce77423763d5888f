// A needle at 10 mm/s through a scene, step by step: the force that the hand would feel, and what happened when.
//   tissue [SCENE]    a scene file, or one that comes with Thimble (paper.toml, layers.toml, vessel.toml, ...)
#include <cstdio>
#include <string>

#include "common/error.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace {

constexpr double kStep_s = 1e-3;
constexpr double kSpeed_m_per_s = 0.010;

void push(thimble::NeedleScene& scene, double depth_m) {
    scene.reset({});
    for (int step = 1; step * kStep_s * kSpeed_m_per_s <= depth_m; ++step) {
        const double start_s = (step - 1) * kStep_s;
        const double needle_m = step * kStep_s * kSpeed_m_per_s;
        scene.step(start_s, kStep_s, {needle_m, needle_m});
        for (const thimble::Transition& change : scene.transitions()) {
            std::printf("%7.3f s  %5.1f mm  %s: %s\n", start_s + change.offset_s, needle_m * 1e3,
                        scene.element_name(change.element).c_str(), std::string(change.phase).c_str());
        }
        scene.clear_transitions();
        if (step % 500 != 0) continue;
        std::printf("%7.3f s  %5.1f mm  tissue %+.4f N, fixture %+.4f N\n", start_s + kStep_s, needle_m * 1e3,
                    scene.force_tissue_N(), scene.force_fixture_N());
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        thimble::NeedleScene scene(thimble::load_scene(argc > 1 ? argv[1] : "paper.toml"),
                                   thimble::solver_maker({}));
        push(scene, 0.060);
        return 0;
    } catch (const thimble::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.code());
    }
}
