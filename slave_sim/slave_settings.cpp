#include "slave_sim/slave_settings.hpp"

#include <algorithm>
#include <string>

#include "slave_sim/element_types.hpp"
#include "slave_sim/needle_scene.hpp"

namespace thimble {

namespace {

// The paper's, with what the session's own tables say otherwise.
SceneDeclaration own_scene(const ConfigFile& file) {
    SceneDeclaration scene;
    scene.name = kPaperScene;
    read_tissue(file.table("tissue"), "tissue", scene);
    read_fixture(file.table("fixture"), "fixture", scene);
    return scene;
}

SceneDeclaration other_scene(const ConfigFile& file, const ConfigTable& own, const std::string& name) {
    for (const char* table : {"tissue", "fixture"}) {
        if (file.root().has(table)) {
            file.root().fail(table, "stands beside slave_sim.scene: what exists is declared in one of them");
        }
    }
    const std::filesystem::path beside = file.folder() / name;
    const bool found = std::filesystem::exists(beside);
    if (found || std::filesystem::exists(name)) file.uses(name);
    SceneDeclaration scene;
    own.load("scene", [&] { scene = load_scene(found ? beside : std::filesystem::path(name)); });
    const NeedleScene built(scene, solver_maker({}));
    // The needle's depth is told from the surface, and a trial ends with contact at the fixture.
    if (built.surface() == nullptr) own.fail("scene", "has no [tissue]: a trial needs a surface");
    if (built.fixture() == nullptr) own.fail("scene", "has no [fixture]: a trial ends by contact with it");
    return scene;
}

TissueMaker read_solver(const ConfigTable& own) {
    SolverChoice choice;
    std::size_t solver = 0;
    own.read("solver", solver, kSolverNames, "How tissue is stepped (docs/scenes.md).");
    own.read("solver_step_s", choice.longest_step_s, 1e-7, 1, "Longest step of a solver that steps.");
    choice.name = kSolverNames[solver];
    return solver_maker(choice);
}

}  // namespace

double SlaveSettings::fixture_position_m() const {
    return NeedleScene(scene, make_tissue).fixture()->position_m();
}

SlaveSettings read_slave_settings(const ConfigFile& file) {
    SlaveSettings s;
    const ConfigTable own = file.table("slave_sim");
    std::string scene, stale = "hold";
    own.read("scene", scene,
             "A scene file instead of [tissue] and [fixture], beside this file or one that comes with the "
             "program.");
    s.scene = scene.empty() ? own_scene(file) : other_scene(file, own, scene);
    s.make_tissue = read_solver(own);
    // An unstable solver is refused here, not in the first trial.
    own.load("solver", [&] { const NeedleScene tried(s.scene, s.make_tissue); });
    file.table("trial").read("contact_hold_s", s.contact_hold, 0.001, 600,
                             "Unbroken contact with the fixture until the beep.");
    own.read("stale", stale, "A needle without commands stands still; anything else is refused.");
    // It would move without a command.
    if (stale != "hold") own.fail("stale", "can only be \"hold\": a needle without commands stands still");
    s.codec = read_codec_settings(file.table("codec"));
    // Fewer packets need more patience: two of them may be lost.
    if (s.codec.command != HapticCodec::kNone)
        s.stale_after = std::max(s.stale_after, s.codec.slave_patience());
    own.read("stale_after_s", s.stale_after, 0.001, 10,
             "Without a command for so long: the needle is held, every force is zero.");
    own.read("longest_step_s", s.longest_step, 0.001, 10,
             "After a longer gap between samples contact starts anew.");
    read_scaling(file.table("master"), s.control.scale);
    s.control.control = read_control_settings(file);
    return s;
}

}  // namespace thimble
