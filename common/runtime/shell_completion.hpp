// Completion scripts for shells, made from the program's own command line, so that both always agree.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace thimble {

struct CompletedWord {
    std::string word;         // "study", "--out", "-o"
    std::string description;  // one line
};

struct CompletedOption {
    std::vector<std::string> names;  // "-o", "--out"
    std::string description;
    bool takes_value = false;
    std::vector<std::string> choices{};  // of the value; empty: a file's name, or anything
};

// The program, or one of its subcommands.
struct CompletedCommand {
    std::string path;  // as typed: "thimble log cat"
    std::vector<CompletedWord> subcommands{};
    std::vector<CompletedOption> options{};
    std::vector<std::string> choices{};  // of its positional words, where they are a few
    bool takes_words = false;            // positional words
};

// The program first, each subcommand after the command it belongs to.
using CommandTree = std::vector<CompletedCommand>;

inline constexpr const char* kCompletedShells[] = {"bash", "zsh", "fish"};

// A script for one of kCompletedShells.
std::string completion_script(const CommandTree& tree, std::string_view shell);

}  // namespace thimble
