// Looks at the machine for the doctor. Files are read below a folder, which is "/" except in tests. It changes nothing and needs no root. Unreadable facts keep their default.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config.hpp"
#include "thimble/doctor/facts.hpp"

namespace thimble {

// Files of /proc and /sys below `root`.
ProcessorFacts gather_processors(const std::filesystem::path& root);
KernelFacts gather_kernel(const std::filesystem::path& root);
CanFacts gather_can(const std::filesystem::path& root);
FirewallFacts gather_firewall(const std::filesystem::path& root);
DeviceFacts gather_devices(const std::filesystem::path& root);

// Asked of the kernel. The timer is measured in a thread of its own, with the scheduling that a node would get.
void gather_time(const ConfigFile& file, double seconds_s, RealtimeFacts& realtime, TimerFacts& timer);
ClockFacts gather_clock();
// All ports of as many conditions as the session has, on every address of this machine.
PortFacts gather_ports(std::uint16_t base_port, unsigned conditions);
// Starts each node of `folder` with --version.
ProgramFacts gather_programs(const std::filesystem::path& folder);
ScreenFacts gather_screen();
SoundFacts gather_sound();

// The chain of `nft list ruleset`'s words that hears incoming packets and drops by default; empty: none.
std::string dropping_chain(const std::string& ruleset);
// Lines of /proc/net/udp that listen at `port`: their sockets' inodes.
std::vector<std::string> udp_inodes(const std::string& table, std::uint16_t port);

}  // namespace thimble
