// The simulated slave's settings in a session's configuration file.
#pragma once

#include <chrono>

#include "common/config.hpp"
#include "common/control/control_settings.hpp"
#include "common/reduction/codec_settings.hpp"
#include "common/shared_values.hpp"
#include "common/time.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {

// The slave's end of a compensator that has two ([control] compensator = "wave" or "two-port"), with what the master's table says of the
// handle.
struct WaveEndSettings {
    bool used = false;      // waves
    bool two_port = false;  // two-port passivity
    double impedance_Ns_per_m = 20, damping_Ns_per_m = 20;
    WaveChannelSettings channel{};
    double position_scale = kPositionScale;
    double force_scale = 1;
    double force_limit_N = kHandleFullScale_N;
    Duration sample_period = std::chrono::milliseconds{1};
};

// The slave's part of a compensator; the handle's numbers are those of `handle`.
WaveEndSettings wave_end_of(const ControlSettings& control, WaveEndSettings handle);

struct SlaveSettings {
    SceneDeclaration scene = paper_scene();
    TissueMaker make_tissue = solver_maker({});
    Duration contact_hold = std::chrono::seconds(5);
    // Without a command for this long the needle is held (the process watches it).
    Duration stale_after = std::chrono::milliseconds(20);
    // Between samples further apart than this, the needle's place is unknown.
    Duration longest_step = std::chrono::milliseconds(100);

    double fixture_position_m() const;  // of the scene's first forbidden region, which trials move
    WaveEndSettings wave{};             // in HF
    CodecSettings codec{};              // of table [codec]
};

// Tables [tissue], [fixture], [trial] and [slave_sim]. Throws Error (usage).
SlaveSettings read_slave_settings(const ConfigFile& file);

}  // namespace thimble
