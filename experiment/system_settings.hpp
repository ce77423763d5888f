// Everything a session's TOML file can say, read and checked as a whole. Each program reads the same file and
// takes its own tables; `thimble` reads all of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config.hpp"
#include "cutaneous_node/cutaneous_settings.hpp"
#include "experiment/session_process.hpp"
#include "master/devices/simulated_handle.hpp"
#include "master/master_node.hpp"
#include "netem/link_settings.hpp"
#include "netem/netem_settings.hpp"
#include "slave_sim/slave_settings.hpp"
#include "visual_node/visual_settings.hpp"

namespace thimble {

// How trials are drawn and what `thimble run` runs. Table [session].
struct SessionPlan {
    std::vector<Modality> modalities{kModalities.begin(), kModalities.end()};
    std::vector<Duration> delays{Duration{0}, std::chrono::milliseconds{50}};  // of the force path, one-way
    std::uint64_t seed = 1;
    std::uint32_t subject = 1;
    double fixture_jitter_m = 0.015;  // half width of the uniform draw around [fixture].position_m
    int lanes = 0;                    // conditions run side by side; 0: one per two cores
};

struct SystemSettings {
    MasterSettings master;
    HandleSettings handle;
    OperatorParameters person;
    SlaveSettings slave;
    CutaneousSettings cutaneous;
    VisualSettings visual;
    NetemSettings netem;
    SessionSettings session;
    SessionPlan plan;
};

// Throws Error (usage) on anything unknown or out of range.
SystemSettings read_system_settings(const ConfigFile& file);
// An empty path gives the defaults, which are the paper's.
SystemSettings load_system_settings(const std::filesystem::path& path);

// Those of the session, its network_delay filled in from both links.
SessionSettings session_settings(const SystemSettings& settings);

}  // namespace thimble
