// The simulated slave's settings in a session's configuration file.
#pragma once

#include <chrono>

#include "common/config.hpp"
#include "common/control/controller_ends.hpp"
#include "common/reduction/codec_settings.hpp"
#include "common/time.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {

// The slave's end of a controller that has two, as "wave" and "two-port" have, with what the master's table says of the handle.
struct SlaveControl {
    ControlSettings control{};
    HandleControlScale scale{};
};

struct SlaveSettings {
    SceneDeclaration scene = paper_scene();
    TissueMaker make_tissue = solver_maker({});
    Duration contact_hold = std::chrono::seconds(5);
    // Without a command for this long the needle is held (the process watches it).
    Duration stale_after = std::chrono::milliseconds(20);
    // Between samples further apart than this, the needle's place is unknown.
    Duration longest_step = std::chrono::milliseconds(100);

    double fixture_position_m() const;  // of the scene's first forbidden region, which trials move
    SlaveControl control{};             // in HF
    CodecSettings codec{};              // of table [codec]
};

// Tables [tissue], [fixture], [trial] and [slave_sim]. Throws Error (usage).
SlaveSettings read_slave_settings(const ConfigFile& file);

}  // namespace thimble
