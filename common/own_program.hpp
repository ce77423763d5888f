// The folder of this program and the variables of its environment.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace thimble {

// The folder of this program and of the other programs of Thimble; /usr/bin if the system does not tell.
inline std::filesystem::path program_folder() {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? std::filesystem::path("/usr/bin") : self.parent_path();
}

// The files that come with the programs: sessions, scenes, profiles, board, fit.
inline std::filesystem::path shipped_files() { return program_folder().parent_path() / "share/thimble"; }

// The value of a variable; empty if it is not set.
inline std::string environment_text(const char* name) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): no thread sets a variable
    return value == nullptr ? "" : value;
}

// TMPDIR, or /tmp.
inline std::string temporary_folder() {
    const std::string set = environment_text("TMPDIR");
    return set.empty() ? "/tmp" : set;
}

}  // namespace thimble
