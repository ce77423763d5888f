// Completion of command lines in shells. A shell's script asks the program itself, so that both always agree.
#pragma once

#include <optional>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

inline constexpr const char* kCompletedShells[] = {"bash", "zsh", "fish"};

// The script for one of kCompletedShells; empty for another shell.
std::string completion_script(const std::string& program, const std::string& shell);

// Answers the two hidden calls of every program, and returns the exit code; nothing for any other call:
//     --completion SHELL    prints the shell's script (the packages' build)
//     --complete WORD...    prints a line of word, tab and description for each way in which the last word may go on (the
//                           scripts). Exit code 1 if there is none: then the shell completes names of files
std::optional<int> answer_shell(const CLI::App& app, int argc, char** argv);

}  // namespace thimble
