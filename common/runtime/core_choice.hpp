// One processor core for the programs of the haptic loop (`core` of [runtime]): a datagram then wakes its receiver without a call
// to another core.
#pragma once

#include <string>

#include "common/config.hpp"

namespace thimble {

inline constexpr int kAnyCore = -1;

// Throws Error (usage) for what is no number of a core.
int read_core(const ConfigFile& file);

// From now on the calling thread runs on this core only. Returns "" or what to tell the user.
std::string keep_to_core(int core);

}  // namespace thimble
