// Table [launch] of a session file: which node runs on which machine, and how `thimble run` gets there.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/config.hpp"
#include "common/messages.hpp"
#include "common/network_settings.hpp"

namespace thimble {

// BatchMode: a question for a password would wait for ever. The rest: a machine that is not there, or no longer, is
// noticed within seconds.
inline constexpr const char* kDefaultExec =
    "ssh -o BatchMode=yes -o ConnectTimeout=10 -o ServerAliveInterval=2 -o ServerAliveCountMax=3 {host}";

struct LaunchSettings {
    std::array<std::string, kRoleCount>
        machines{};                   // by Role; empty: this machine. The session's own is always this one
    std::string exec = kDefaultExec;  // runs a command on {host}; words between blanks, no quotes
    std::string programs;             // folder there; empty: sought in PATH there
    Duration reach = std::chrono::seconds{20};  // for all machines to be reached
    Duration lease = std::chrono::seconds{10};  // without a sign of this program for so long nodes end
    bool shares_loopback = false;  // the machines have this one's 127.0.0.1: containers, other users
    // By Role, absolute: a program of the user in the place of thimble-ROLE; empty: none.
    std::array<std::filesystem::path, kRoleCount> own_programs{};

    const std::string& machine(Role role) const { return machines[static_cast<std::size_t>(role)]; }
    const std::filesystem::path& own_program(Role role) const {
        return own_programs[static_cast<std::size_t>(role)];
    }
    bool anywhere_else() const;
    // The first such key of the file, "program_slave_sim"; empty: all programs are Thimble's.
    std::string own_program_key() const;
    // Throws Error (usage) if there is one: `command` starts no program of a user.
    void require_no_own_program(std::string_view command) const;
};

// Throws Error (usage), also for names that could pass for an option of the program that `exec` names.
LaunchSettings read_launch_settings(const ConfigFile& file);
// `exec` in words, {host} replaced. Throws Error (usage) if it has no words.
std::vector<std::string> exec_words(const LaunchSettings& launch, const std::string& machine);

// Throws Error (usage) if nodes on different machines that talk to each other have hosts that cannot work:
// addresses that mean "this machine", or one and the same for two machines.
void check_hosts(const LaunchSettings& launch, const NetworkSettings& network);

}  // namespace thimble
