// Runs another program to its end and keeps what it said.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thimble {

struct ProgramResult {
    int exit_code = 0;   // 128 + signal if a signal ended it
    std::string output;  // stdout and stderr, as they came
};

// Searches PATH, runs in `directory`, stdin empty. Throws Error (run failed) if the program cannot be
// started; `remedy` completes that message ("install ...").
ProgramResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& directory, const std::string& remedy);

}  // namespace thimble
