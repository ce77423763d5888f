// The board compares controllers by codecs by conditions, from the files in deploy/board. Each is a fragment of a session file.
// The session of a row is its three fragments together, read by the reader of every session.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "session/settings/system_settings.hpp"

namespace thimble {

// A controller or a codec.
struct BoardEntry {
    std::string name, about;
    std::string keys;      // TOML
    std::string plugin{};  // its file; empty: it has none, and the code is ours
};

struct BoardCondition {
    std::string name;  // "50ms+jitter", "wifi+passive"
    std::string network, hands, tissue, scene;
    double delay_s = 0;             // of the force path
    double jitter_s = 0, loss = 0;  // of the ideal network; a profile has its own
    std::string keys;               // TOML
};

struct BoardPlan {
    std::uint32_t version = 0;
    std::vector<BoardEntry> controllers, codecs;
    std::vector<BoardCondition> conditions;
    std::uint32_t trials = 30;  // of each row, each another subject
    std::uint64_t seed = 1;

    std::size_t rows() const { return controllers.size() * codecs.size() * conditions.size(); }
};

// Controllers outside, conditions inside.
struct BoardPlace {
    const BoardEntry &controller, &codec;
    const BoardCondition& condition;
};
BoardPlace place_of(const BoardPlan& plan, std::size_t row);
// "wave, every-sample, 50ms+jitter"
std::string row_name(const BoardPlace& place);

// The folder of the files that came with the program.
std::filesystem::path board_folder();
// All that the files in this folder name. Throws Error (usage) with the file and the key.
BoardPlan read_board(const std::filesystem::path& folder);
// A plug-in as a controller in HF, named as its file. Throws Error (usage) for a name that is there, or that is no file's name elsewhere.
void add_plugin(BoardPlan& plan, const std::filesystem::path& file);
// Removes entries that are not named. A kind stays whole if none of its entries is named. Throws Error (usage).
void keep_only(BoardPlan& plan, const std::vector<std::string>& names);
// The text that decides the table's bytes. A plug-in is in it with its hash.
std::string plan_text(const BoardPlan& plan);

// The session file of a row, whose first trial is that of `subject`. `thimble run --clock virtual` runs it again.
std::string row_session(const BoardPlan& plan, const BoardPlace& place, std::uint32_t subject = 1);

// Pieces of session files, as TOML text, put together.

// Later fragments replace keys of earlier ones; their tables are joined. Throws Error (usage) that names `name` for what is not TOML.
std::string joined_fragments(std::span<const std::string> fragments, const std::string& name);

}  // namespace thimble
