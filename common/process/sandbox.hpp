// The same command once more inside bubblewrap (a Debian package), for plug-ins of strangers. It sees all files, but writes only in the
// folders named. It has no network and sees no other process.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thimble {

// This process runs inside already.
bool in_sandbox();

// Why this machine has no sandbox, with what to do; empty: it has one.
std::string why_no_sandbox();

// Replaces this process by its own command line inside the sandbox. The folders are made where they are missing. Does nothing inside.
// Throws Error (run failed) if that cannot be done: ask why_no_sandbox() before.
void enter_sandbox(const std::vector<std::filesystem::path>& writable);

}  // namespace thimble
