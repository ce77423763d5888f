// A whole file from one that was cut off or damaged.
#pragma once

#include <filesystem>

#include "common/log/mcap_writer.hpp"
#include "session/log/logged_file.hpp"

namespace thimble {

struct RepairResult {
    McapScan scan;                // of the old file
    std::uint64_t messages = 0;   // in the new one
    std::uint64_t bytes_cut = 0;  // of the old one, behind the last whole record
};

// Everything of `file` that is whole, numbered anew. Does not finish the other.
McapScan copy_whole_records(Bytes file, McapWriter& to);

// Writes everything of `from` that is whole to the new file `to`, with an index. Throws Error: data, if there is nothing to
// repair; usage, if `to` exists; run failed, if it cannot be written.
RepairResult repair_log(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace thimble
