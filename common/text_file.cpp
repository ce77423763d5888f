#include "common/text_file.hpp"

#include <fstream>
#include <system_error>

#include "common/error.hpp"

namespace thimble {

void write_text_file(const std::filesystem::path& path, std::string_view text) {
    refuse_folder(path);
    std::ofstream out(path, std::ios::binary);
    out << text;
    out.close();  // a full disk shows here at the latest
    if (!out) {
        throw Error(ExitCode::kRunFailed, "{}: cannot be written; check directory and free space",
                    path.string());
    }
}

void refuse_folder(const std::filesystem::path& file) {
    std::error_code unknown;
    if (!std::filesystem::is_directory(file, unknown)) return;
    throw Error(ExitCode::kUsage, "{}: is a folder, and a file is meant: name a file", file.string());
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code failure;
    if (!folder.empty()) std::filesystem::create_directories(folder, failure);
    std::error_code unknown;
    for (auto part = folder; failure && part.has_relative_path(); part = part.parent_path()) {
        if (!std::filesystem::exists(part, unknown)) continue;
        if (std::filesystem::is_directory(part, unknown)) break;
        throw Error(ExitCode::kUsage, "{}: is a file, and a folder is meant: name another folder",
                    part.string());
    }
    if (failure) {
        throw Error(ExitCode::kUsage,
                    "{}: cannot be made: {}; name another folder, or change its permissions", folder.string(),
                    failure.message());
    }
}

}  // namespace thimble
