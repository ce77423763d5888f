// Everything a session's TOML file can say, read and checked as a whole. Each program reads the same file and
// takes its own tables; `thimble` reads all of them.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/config.hpp"
#include "common/log/log_settings.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "cutaneous_node/cutaneous_settings.hpp"
#include "master/devices/simulated_handle.hpp"
#include "master/master_node.hpp"
#include "netem/link_settings.hpp"
#include "netem/netem_settings.hpp"
#include "session/records/participant.hpp"
#include "session/settings/launch_settings.hpp"
#include "session/settings/protocol_settings.hpp"
#include "session/settings/session_settings.hpp"
#include "slave_sim/slave_settings.hpp"
#include "visual_node/page_set.hpp"
#include "visual_node/visual_settings.hpp"

namespace thimble {

enum class TrialOrder : std::uint8_t {
    kShuffled,  // the paper's: all trials of a subject in random order (Fisher-Yates)
    // Blocks of one trial per modality, each block a row of a Williams design (E. J. Williams 1949): within
    // blocks every modality follows every other equally often, so that carry-over is balanced as well as
    // position. Rows go round by subject and block; which modality is which letter is drawn once per study.
    kWilliams,
};
inline constexpr std::array<std::string_view, 2> kTrialOrderNames{"shuffled", "williams"};
constexpr const char* to_string(TrialOrder order) {
    return kTrialOrderNames[static_cast<std::size_t>(order)].data();
}
std::optional<TrialOrder> parse_order(std::string_view text);

// Which trials a session has, and how they are drawn: the same for every command. Table [session].
struct SessionPlan {
    std::vector<Modality> modalities{kModalities.begin(), kModalities.end()};
    // Of the force path, one-way: delays_s, else the delay of [netem.force], else that of [protocol]'s experiments.
    std::vector<Duration> delays{Duration{0}, std::chrono::milliseconds{50}};
    bool names_modalities = false, names_delays = false;  // the file gives them
    std::uint64_t seed = 1;
    std::uint32_t subject = 1;  // of a human subject: the participant, 0 where the file names none
    SubjectKind kind = SubjectKind::kVirtual;
    TrialOrder order = TrialOrder::kShuffled;
    double fixture_jitter_m = 0.015;  // half width of the uniform draw around [fixture].position_m
    int parallel_conditions = 0;      // conditions run side by side; 0: as the cores allow
};

struct SystemSettings {
    MasterSettings master;
    HandleSettings handle;
    OperatorParameters person;
    SlaveSettings slave;
    CutaneousSettings cutaneous;
    VisualSettings visual;
    PageSet pages;
    NetemSettings netem;
    SessionSettings session;
    SessionPlan plan;
    std::optional<ProtocolSettings> protocol;  // there if the file has a table [protocol]
    DatasetSettings dataset;
    LaunchSettings launch;
    LogSettings log;
    RuntimeSettings runtime;
    std::filesystem::path file;  // where all this was read from; empty: nowhere
};

// Throws Error (usage) on anything unknown or out of range.
SystemSettings read_system_settings(const ConfigFile& file);
// One key of the file with another value: "handle.friction_N", SI.
struct SettingChange {
    std::string key;
    double value = 0;
};
// An empty path gives the defaults, which are the paper's. The changes stand as if they were in the file.
SystemSettings load_system_settings(const std::filesystem::path& path,
                                    const std::vector<SettingChange>& changes = {});

// All keys of the file with their values, the defaults included, as a file would write them. An empty path: the defaults. The changes
// stand as if they were in the file. `options`: keys that a command's options replace, with the value as a file would write it.
std::string all_parameters(const std::filesystem::path& path, const std::vector<SettingChange>& changes = {},
                           const std::vector<std::pair<std::string, std::string>>& options = {});

// The same session with this delay of the force path, as a condition of an experiment has it.
SystemSettings with_force_delay(SystemSettings settings, Duration delay);

// Throws Error (usage) if a person takes part: `command` runs virtual subjects with the simulated handle.
void require_simulated_devices(const SystemSettings& settings, std::string_view command);
// Likewise, and if [launch] names a program that virtual time does not have.
void require_virtual_subjects(const SystemSettings& settings, std::string_view command);

// Those of the session, its network_delay filled in from both links.
SessionSettings session_settings(const SystemSettings& settings);

// Sessions that come with the program (deploy/sessions). Commands that take a session file take one of these by its name, too.

// By experiment, from 1.
inline constexpr std::array<std::string_view, 3> kPaperSessions{"paper-experiment-1", "paper-experiment-2",
                                                                "paper-experiment-3"};

// The file at this path, or that of the session of this name. Nodes, other machines and logs get the file, so it has to exist.
// Throws Error (usage) that lists the names.
std::filesystem::path find_session_file(const std::string& given);

// The name of a file that came with the program; nothing for any other one.
std::optional<std::string> shipped_name(const std::filesystem::path& file);

// The file says the trials of one of the paper's experiments, and nothing else but a seed and an order, wherever it lies and
// whatever its name. Throws Error (usage) if it is no session file.
bool is_paper_session(const std::filesystem::path& file);

}  // namespace thimble
