// Sessions that come with the program (deploy/sessions). Commands that take a session file take one of these by its name, too.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace thimble {

// By experiment, from 1.
inline constexpr std::array<std::string_view, 3> kPaperSessions{"paper-experiment-1", "paper-experiment-2",
                                                                "paper-experiment-3"};

// The folder of the program that runs. The others lie beside it; its sessions are in ../share/thimble/sessions.
std::filesystem::path program_folder();

// The file at this path, or that of the session of this name. Nodes, other machines and logs get the file, so it has to exist.
// Throws Error (usage) that lists the names.
std::filesystem::path find_session_file(const std::string& given);

// The name of a file that came with the program; nothing for any other one.
std::optional<std::string> shipped_name(const std::filesystem::path& file);

// The file says the trials of one of the paper's experiments, and nothing else but a seed and an order, wherever it lies and
// whatever its name. Throws Error (usage) if it is no session file.
bool is_paper_session(const std::filesystem::path& file);

}  // namespace thimble
