// The same command once more inside bubblewrap (a Debian package), for plug-ins of strangers. It reads all files that the user may read,
// except in /run and /tmp: these are empty inside and forgotten at its end. It writes only in the folders named. It has no network and no
// terminal and sees no other process. A Unix socket that lies elsewhere, in the home folder for instance, still connects.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thimble {

// This process runs inside already.
bool in_sandbox();

// Why this machine has no sandbox, with what to do; empty: it has one.
std::string why_no_sandbox();

// Replaces this process by its own command line inside the sandbox. The writable folders are made where they are missing; the readable
// ones may lie in /run or /tmp. Does nothing inside. Ctrl-C ends the inside at once.
// Throws Error: usage for a folder that cannot be shown; run failed if it cannot be done: ask why_no_sandbox() before.
void enter_sandbox(const std::vector<std::filesystem::path>& writable,
                   const std::vector<std::filesystem::path>& readable = {});

}  // namespace thimble
