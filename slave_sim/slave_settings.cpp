#include "slave_sim/slave_settings.hpp"

#include <algorithm>
#include <string>

#include "common/control/built_in_controllers.hpp"
#include "common/stale_policy.hpp"
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
            file.root().fail(
                table, "cannot be used together with slave_sim.scene: declare the scene in one of them");
        }
    }
    const std::filesystem::path beside = file.folder() / name;
    const bool found = std::filesystem::exists(beside);
    if (found || std::filesystem::exists(name)) file.uses(name);
    SceneDeclaration scene;
    own.load("scene", [&] { scene = load_scene(found ? beside : std::filesystem::path(name)); });
    const NeedleScene built(scene, solver_maker({}));
    // The needle's depth is relative to the surface, and a trial ends with contact at the fixture.
    if (built.surface() == nullptr) own.fail("scene", "has no [tissue]: a trial needs a surface");
    if (built.fixture() == nullptr) own.fail("scene", "has no [fixture]: a trial ends by contact with it");
    return scene;
}

TissueMaker read_solver(const ConfigTable& own) {
    SolverChoice choice;
    std::size_t solver = 0;
    own.read("solver", solver, kSolverNames, "Solver of the tissue (docs/scenes.md).");
    own.read("solver_step_s", choice.longest_step_s, 1e-7, 1, "Longest time step of the solver.");
    choice.name = kSolverNames[solver];
    return solver_maker(choice);
}

void read_robot(const ConfigTable& table, SlaveSettings& s) {
    s.ros2 = read_ros2_settings(table);
    RobotLimits& robot = s.robot;
    table.read("shallowest_m", robot.shallowest_m, -1, 1, "Outermost position of a needle.");
    table.read("deepest_m", robot.deepest_m, -1, 1, "Deepest position of a needle.");
    table.read("speed_limit_m_per_s", robot.speed_limit_m_per_s, 0.001, 5,
               "Highest speed of a commanded needle.");
    table.read("force_limit_N", robot.force_limit_N, 0.1, 1000,
               "Larger forces of the robot are cut to this value.");
    if (robot.deepest_m <= robot.shallowest_m) table.fail("deepest_m", "must be greater than shallowest_m");
}

// Its own end of a controller solves for the simulated needle's place; a robot's place is measured. Between two packets of a codec the
// needle is simulated as well.
void require_one_end(const ConfigFile& file, const SlaveSettings& s) {
    if (s.device == SlaveDevice::kSimulated) return;
    if (s.codec.command != HapticCodec::kNone)
        file.table("codec").fail("command",
                                 "leaves out commands, but a robot needs every command: use \"none\", or "
                                 "[slave_sim] device = \"simulated\"");
    if (!has_two_ends(s.control.control)) return;
    file.table("control").fail("compensator",
                               "has an end at the slave, which works with a simulated needle only: use "
                               "another one, or [slave_sim] device = \"simulated\"");
}

Duration longest_between_commands(const SlaveSettings& s) {
    const Duration period = s.control.scale.sample_period;
    return s.codec.command == HapticCodec::kNone ? period : std::max(period, s.codec.refresh);
}

}  // namespace

double SlaveSettings::fixture_position_m() const {
    return NeedleScene(scene, make_tissue).fixture()->position_m();
}

SlaveSettings read_slave_settings(const ConfigFile& file) {
    SlaveSettings s;
    const ConfigTable own = file.table("slave_sim");
    std::string scene, stale = "hold";
    own.read("device", s.device, {"simulated", "ros2"}, "Device that moves the needle (docs/ros2.md).");
    own.read("scene", scene,
             "Scene file, beside this file or a built-in one; replaces [tissue] and [fixture].");
    s.scene = scene.empty() ? own_scene(file) : other_scene(file, own, scene);
    s.make_tissue = read_solver(own);
    // An unstable solver is refused here, not in the first trial.
    own.load("solver", [&] { const NeedleScene tried(s.scene, s.make_tissue); });
    file.table("trial").read("contact_hold_s", s.contact_hold, 0.001, 600,
                             "Unbroken contact with the fixture until the beep.");
    own.read("stale", stale,
             "Reaction to missing commands; only \"hold\" is possible: the needle stands still.");
    // Other policies would move the needle without a command.
    if (stale != "hold") own.fail("stale", "must be \"hold\": a needle without commands stands still");
    s.codec = read_codec_settings(file.table("codec"));
    // Fewer packets need more patience: two of them may be lost.
    if (s.codec.command != HapticCodec::kNone)
        s.stale_after = std::max(s.stale_after, s.codec.slave_patience());
    own.read("stale_after_s", s.stale_after, 0.001, 10,
             "Time without a command after which the needle is held and every force is zero.");
    read_scaling(file.table("master"), s.control.scale);
    require_fresh_samples(file, "slave_sim", s.control.scale.sample_period, s.stale_after,
                          "holds the needle before each sample");
    const Duration apart = longest_between_commands(s);
    s.longest_step = std::max(s.longest_step, 2 * apart);
    own.read("longest_step_s", s.longest_step, 0.001, 10,
             "Longest gap between samples within one contact; after a longer one contact begins again.");
    if (s.longest_step <= apart)
        own.fail("longest_step_s",
                 "ends each contact at the next command, which may come {:g} s later: use a longer one",
                 to_seconds(apart));
    s.control.control = read_control_settings(file);
    read_robot(own.table("ros2"), s);
    require_one_end(file, s);
    return s;
}

}  // namespace thimble
