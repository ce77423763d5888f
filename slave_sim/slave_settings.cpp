#include "slave_sim/slave_settings.hpp"

#include <string>

#include "slave_sim/element_types.hpp"
#include "slave_sim/needle_scene.hpp"

namespace thimble {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

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
    SceneDeclaration scene = load_scene(found ? beside : std::filesystem::path(name));
    const NeedleScene built(scene, solver_maker({}));
    // The needle's depth is told from the surface, and a trial ends with contact at the fixture.
    if (built.surface() == nullptr) own.fail("scene", "has no [tissue]: a trial needs a surface");
    if (built.fixture() == nullptr) own.fail("scene", "has no [fixture]: a trial ends by contact with it");
    return scene;
}

TissueMaker read_solver(const ConfigTable& own) {
    SolverChoice choice;
    choice.name = kSolverNames[own.choice("solver", 0, {kSolverNames.begin(), kSolverNames.end()})];
    choice.longest_step_s = own.number("solver_step_s", choice.longest_step_s, 1e-7, 1);
    return solver_maker(choice);
}

// The master checks table [master]. Here it is only read.
WaveEndSettings read_wave_end(const ConfigFile& file) {
    const ConfigTable master = file.table("master");
    WaveEndSettings wave;
    wave.position_scale = master.number("position_scale", wave.position_scale, 0.01, 100);
    wave.force_scale = master.number("force_scale", wave.force_scale, 0, 100);
    wave.force_limit_N = master.number("force_limit_N", wave.force_limit_N, 0, 1000);
    wave.sample_period =
        master.seconds("sample_period_s", wave.sample_period, std::chrono::microseconds{100}, seconds(1));
    return wave_end_of(read_control_settings(file.table("control")), wave);
}

}  // namespace

WaveEndSettings wave_end_of(const ControlSettings& control, WaveEndSettings handle) {
    handle.used = control.compensator == Compensator::kWave;
    handle.two_port = control.compensator == Compensator::kTwoPort;
    handle.impedance_Ns_per_m = control.wave_impedance_Ns_per_m;
    handle.damping_Ns_per_m = control.wave_slave_damping_Ns_per_m;
    handle.channel = control.channel;
    return handle;
}

double SlaveSettings::fixture_position_m() const {
    return NeedleScene(scene, make_tissue).fixture()->position_m();
}

SlaveSettings read_slave_settings(const ConfigFile& file) {
    SlaveSettings s;
    const ConfigTable own = file.table("slave_sim");
    const std::string scene = own.text("scene", "");
    s.scene = scene.empty() ? own_scene(file) : other_scene(file, own, scene);
    s.make_tissue = read_solver(own);
    const NeedleScene tried(s.scene,
                            s.make_tissue);  // an unstable solver is refused here, not in the first trial
    s.contact_hold =
        file.table("trial").seconds("contact_hold_s", s.contact_hold, milliseconds(1), seconds(600));
    // It would move without a command.
    if (own.text("stale", "hold") != "hold")
        own.fail("stale", "can only be \"hold\": a needle without commands stands still");
    s.stale_after = own.seconds("stale_after_s", s.stale_after, milliseconds(1), seconds(10));
    s.longest_step = own.seconds("longest_step_s", s.longest_step, milliseconds(1), seconds(10));
    s.wave = read_wave_end(file);
    return s;
}

}  // namespace thimble
