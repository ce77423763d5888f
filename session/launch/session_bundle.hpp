// A session file with every file that it names: what a node on another machine needs to read the same settings.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thimble {

struct BundledFile {
    std::string name;  // relative, in the folder of the session file; '/' between folders
    std::string text;
};

struct SessionBundle {
    std::vector<BundledFile> files;  // the session file first
};

// Reads them all. Throws Error (usage) if the session file cannot be read with the others from its own folder alone:
// a name that is absolute, leads out of the folder, or was found elsewhere.
SessionBundle make_bundle(const std::filesystem::path& session);

// How it is sent: for each file a line "SIZE NAME" and SIZE bytes, then the line "end".
std::string to_stream(const SessionBundle& bundle);

}  // namespace thimble
