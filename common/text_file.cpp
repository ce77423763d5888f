#include "common/text_file.hpp"

#include <fstream>
#include <system_error>

#include "common/error.hpp"

namespace thimble {

void write_text_file(const std::filesystem::path& path, std::string_view text) {
    std::ofstream out(path, std::ios::binary);
    out << text;
    out.close();  // a full disk shows here at the latest
    if (!out) {
        throw Error(ExitCode::kRunFailed, "{}: cannot be written; check directory and free space",
                    path.string());
    }
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code failure;
    if (!folder.empty()) std::filesystem::create_directories(folder, failure);
    if (failure) {
        throw Error(ExitCode::kUsage,
                    "{}: cannot be made: {}; name another folder, or change its permissions", folder.string(),
                    failure.message());
    }
}

}  // namespace thimble
