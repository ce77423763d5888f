// What the simulated slave reads from a session's configuration file.
#pragma once

#include <chrono>

#include "common/config.hpp"
#include "common/time.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {

struct SlaveSettings {
    SceneDeclaration scene = paper_scene();
    TissueMaker make_tissue = solver_maker({});
    Duration contact_hold = std::chrono::seconds(5);
    // Without a command for this long the needle is held (the process watches it).
    Duration stale_after = std::chrono::milliseconds(20);
    // Between samples further apart than this, nobody knows where the needle was.
    Duration longest_step = std::chrono::milliseconds(100);

    double fixture_position_m() const;  // of the scene's first forbidden region, which trials move
};

// Tables [tissue], [fixture], [trial] and [slave_sim]. Throws Error (usage).
SlaveSettings read_slave_settings(const ConfigFile& file);

}  // namespace thimble
