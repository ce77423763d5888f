#include "common/text_file.hpp"

#include <fstream>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {

void write_text_file(const std::filesystem::path& path, std::string_view text) {
    std::ofstream out(path, std::ios::binary);
    out << text;
    out.close();  // a full disk shows here at the latest
    if (!out) {
        throw Error(ExitCode::kRunFailed,
                    fmt::format("{}: cannot be written; check directory and free space", path.string()));
    }
}

}  // namespace thimble
