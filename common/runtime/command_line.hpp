// The part of the command line that all programs share.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "common/csv/csv_file.hpp"
#include "common/error.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
}  // namespace CLI

namespace thimble {

// Nothing if the program is to go on, else its exit code: what was asked for (--help, --version) or is wrong has
// been said. Counts are digits alone, without a sign, numbers finite, values not empty, whatever else their options allow.
// Every program also answers a shell that completes its words (answer_shell), and takes `help [COMMAND...]` and `version` as
// first words.
std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv);

// Options for nodes. A source that includes CLI11 compiles all of it, which takes 10 of the 17 s of thimble-master.
// The value of a word stands in the help as the default. `needs`: an option that must be given, too; null: none.
void add_flag(CLI::App& command, const char* name, bool& value, const char* help);
void add_word_option(CLI::App& command, const char* name, std::string& word,
                     const std::vector<std::string>& allowed, const char* help, const char* needs = nullptr);
void add_file_option(CLI::App& command, const char* name, std::string& file, const char* help);

// Options that mean the same in every command. `work` names what --resume goes on with: "study".
void add_jobs_option(CLI::App& command, unsigned& jobs);
CLI::Option* add_resume_options(CLI::App& command, IfExists& if_exists, const std::string& work);

// Throws Error (usage) if a list holds a value twice: what it stands for would be made, and shown, twice.
template <class Value>
void refuse_twice(const char* option, std::vector<Value> values) {
    std::sort(values.begin(), values.end());
    const auto twice = std::adjacent_find(values.begin(), values.end());
    if (twice != values.end())
        throw Error(ExitCode::kUsage, "{}: {} is given twice: leave one out", option, *twice);
}

// Completion in shells. A shell's script asks the program itself, so that both always agree.
inline constexpr const char* kCompletedShells[] = {"bash", "zsh", "fish"};

// The script for one of kCompletedShells.
std::string completion_script(const std::string& program, const std::string& shell);

// Answers the two hidden calls of every program and returns the exit code. For any other call it returns nothing.
//     --completion SHELL    prints the shell's script. The build of the packages calls it.
//     --complete WORD...    prints a line of word, tab and description for each completion of the last word. The scripts call it.
//                           Without a completion the exit code is 1, and the shell completes names of files.
std::optional<int> answer_shell(const CLI::App& app, int argc, char** argv);

}  // namespace thimble
