#include "common/csv/csv_file.hpp"

#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>
#include <unistd.h>

#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

const char* open_mode(IfExists if_exists) {
    switch (if_exists) {
        case IfExists::kReplace:
            return "we";
        case IfExists::kContinue:
            return "ae";
        case IfExists::kRefuse:
            break;
    }
    return "wxe";  // x: the file must not exist, decided by the kernel
}

std::string reason() { return std::generic_category().message(errno); }

}  // namespace

CsvFile::CsvFile(const std::filesystem::path& path, IfExists if_exists) : path_(path) {
    refuse_folder(path);
    file_.reset(std::fopen(path.c_str(), open_mode(if_exists)));
    if (!file_ && errno == EEXIST) {
        throw Error(ExitCode::kUsage,
                    "{}: already exists and is not overwritten; name another folder, or say --overwrite",
                    path.string());
    }
    if (!file_ && (errno == EMFILE || errno == ENFILE)) {
        throw Error(ExitCode::kRunFailed, "{}: cannot be created: {}; raise 'ulimit -n'", path.string(),
                    reason());
    }
    if (!file_) {
        throw Error(ExitCode::kUsage, "{}: cannot be created: {}; check directory and permissions",
                    path.string(), reason());
    }
    std::error_code ignored;
    if (if_exists == IfExists::kContinue) is_new_ = std::filesystem::file_size(path, ignored) == 0;
}

void CsvFile::write(std::string_view text) {
    require_open();
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) fail("written");
}

void CsvFile::flush() {
    require_open();
    if (std::fflush(file_.get()) != 0) fail("written");
}

void CsvFile::sync() {
    flush();
    // Pipes and terminals cannot be synchronised and need not be.
    if (::fsync(::fileno(file_.get())) != 0 && errno != EINVAL && errno != EROFS) fail("synchronised");
}

void CsvFile::require_open() const {
    if (file_) return;
    throw Error(ExitCode::kRunFailed,
                "{}: is no longer written, because a part of it could not be; check the disk's free space",
                path_.string());
}

void CsvFile::fail(const char* doing) {
    const std::string why = reason();
    file_.reset();
    throw Error(ExitCode::kRunFailed, "{}: cannot be {}: {}; check the disk's free space", path_.string(),
                doing, why);
}

void keep_lines(const std::filesystem::path& path, std::size_t lines) {
    std::ifstream in(path, std::ios::binary);
    if (!in) return;
    std::uintmax_t kept = 0;
    std::size_t newlines = 0;
    for (std::string line; newlines <= lines && std::getline(in, line) && !in.eof(); ++newlines) {
        kept += line.size() + 1;
    }
    in.close();
    std::error_code failure;
    if (kept < std::filesystem::file_size(path, failure)) std::filesystem::resize_file(path, kept, failure);
    if (failure) {
        throw Error(ExitCode::kRunFailed, "{}: cannot be cut back to its whole lines: {}", path.string(),
                    failure.message());
    }
}

}  // namespace thimble
