// npm's bids-validator, where deploy/install-validators has put it.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/read_text.hpp"

namespace thimble {

// Its file; empty: it is not installed.
inline std::string bids_validator() {
    const std::string file = THIMBLE_SOURCE_DIR "/build/bids_validator/cli-1.15.0.js";
    return std::filesystem::exists(file) ? file : "";
}

// Its JSON about this dataset; no object where it failed, for the reason in `said`.err.
inline nlohmann::json judged_by_bids(const std::filesystem::path& dataset,
                                     const std::filesystem::path& said) {
    const std::string command = fmt::format(
        "node -e 'require(\"{}\").default([\"{}\", \"--json\"]).catch(c => process.exit(c))' > '{}' 2> "
        "'{}.err'",
        bids_validator(), dataset.string(), said.string(), said.string());
    if (std::system(command.c_str()) == -1) return {};  // its exit code counts warnings too
    return nlohmann::json::parse(read_text(said), nullptr, false);
}

}  // namespace thimble
