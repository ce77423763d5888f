#include "session/play/scratch_folder.hpp"

#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {

ScratchFolder::ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "thimble_play_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
        throw Error(
            ExitCode::kRunFailed,
            fmt::format("cannot make a folder for logs at {}: set TMPDIR to one that can be written to",
                        name));
    }
    path_ = name;
}

ScratchFolder::~ScratchFolder() {
    if (kept_) return;
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace thimble
