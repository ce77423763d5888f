// Shared by several commands: options, the programs beside this one, checks before a run, results.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/report/report.hpp"
#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "session/records/trial_table.hpp"
#include "session/settings/system_settings.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
}  // namespace CLI

namespace thimble {

// The commit that this program was built from, "-dirty" behind it if the sources had changed; "unknown" without git.
const char* source_commit();

// Values that a command has instead of those of its session files.
struct OtherValues {
    std::filesystem::path fit{};           // the fit that `changes` come from; empty: none
    std::vector<SettingChange> changes{};  // its keys
    Provenance options{};  // keys of the file that options replace, with the value as a file would write it
};

// For a report's provenance: the commit, each session file as it was read, and all parameters that ran. An empty path: the defaults.
Provenance made_with(const std::vector<std::filesystem::path>& session_files, const OtherValues& other = {});

// --base-port; 0 unless it is given.
void add_base_port_option(CLI::App& command, int& base_port);

// [network] and [security] of a session file, or of none where it is empty, at `base_port` unless that is 0.
NetworkSettings network_of(const std::string& session_file, int base_port);

// --out of a command that writes one file: that file where it ends as `name` does, else `name` in that folder, which is made.
// Throws Error (usage) where it ends as another kind of result.
std::filesystem::path output_file(const std::filesystem::path& out, const char* name);

// The argument for a session file. After parsing, `file` has the path of a session that was named.
CLI::Option* add_session_option(CLI::App& command, std::string& file, const std::string& help);

// --seed of a command whose sessions have it as [session] seed, which is below 2^63.
CLI::Option* as_session_seed(CLI::Option* option);

// Throws Error (usage): a device of a node on this machine for which this build has no driver (THIMBLE_DEVICES=OFF)
// or program, or letters of [instructions] that the window's font lacks (where there are windows).
void check_build(const SystemSettings& settings);

// Prints the results of a run or a study: the answer in three sentences, and the report's place in `folder`. As JSON
// it prints the folder's summary.json instead. Nothing if that is not there.
void say_results(bool json, const std::filesystem::path& folder, const std::vector<TrialRow>& rows);

}  // namespace thimble
