#include "common/csv/csv_file.hpp"

#include <cerrno>
#include <fcntl.h>
#include <fstream>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

int open_flags(IfExists if_exists) {
    switch (if_exists) {
        case IfExists::kReplace:
            return 0;  // emptied once it is locked
        case IfExists::kContinue:
            return O_APPEND;
        case IfExists::kRefuse:
            break;
    }
    return O_EXCL;  // the file must not exist, decided by the kernel
}

// A start that failed leaves a header, or a part of it.
bool holds_no_more_than(std::string_view header, const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::string text(header.size() + 1, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    return in.eof() && header.starts_with(text);
}

// The file that an earlier start left without a line. -1: it has some, or another program writes it now.
int open_unused(const std::filesystem::path& path, std::string_view header) {
    const int there = open_to_write(path, 0);
    if (there < 0) return there;
    const bool unused = ::flock(there, LOCK_EX | LOCK_NB) == 0 && holds_no_more_than(header, path) &&
                        ::ftruncate(there, 0) == 0;
    if (unused) return there;
    ::close(there);
    errno = EEXIST;
    return -1;
}

// Streams such as pipes have no path that could vanish.
bool has_a_place(std::FILE* file) {
    struct stat status {};
    return ::fstat(::fileno(file), &status) != 0 || !S_ISREG(status.st_mode) || status.st_nlink > 0;
}

std::string reason() { return std::generic_category().message(errno); }

}  // namespace

CsvFile::CsvFile(const std::filesystem::path& path, IfExists if_exists, std::string_view header)
    : path_(path) {
    refuse_folder(path);
    int descriptor = open_to_write(path, open_flags(if_exists));
    if (descriptor < 0 && errno == EEXIST && !header.empty()) descriptor = open_unused(path, header);
    if (descriptor < 0 && errno == EEXIST) {
        throw Error(
            ExitCode::kUsage,
            "{}: already exists and is not overwritten; name another folder, or add --overwrite, where "
            "the command has it",
            path.string());
    }
    if (descriptor < 0) fail_to_create(path, errno);
    // Pipes, and some disks of other machines, have no locks.
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(descriptor);
        throw Error(ExitCode::kUsage, "{}: another program is writing this file; name another folder",
                    path.string());
    }
    if (if_exists == IfExists::kReplace) static_cast<void>(::ftruncate(descriptor, 0) == 0);
    file_.reset(::fdopen(descriptor, "w"));
    had_a_place_ = has_a_place(file_.get());
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
    if (!had_a_place_ || has_a_place(file_.get())) return;
    file_.reset();
    throw Error(ExitCode::kRunFailed,
                "{}: was deleted during the run; start again, and leave the folder in place", path_.string());
}

void CsvFile::sync() {
    flush();
    // Pipes and terminals cannot be synchronised and need not be.
    if (::fsync(::fileno(file_.get())) != 0 && errno != EINVAL && errno != EROFS) fail("synchronised");
}

void CsvFile::require_open() const {
    if (file_) return;
    throw Error(ExitCode::kRunFailed,
                "{}: could not be written completely, so writing has stopped; check the disk's free space",
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
    refuse_half_read(in, path);  // or the lines behind would be cut off
    in.close();
    std::error_code failure;
    if (kept < std::filesystem::file_size(path, failure)) std::filesystem::resize_file(path, kept, failure);
    if (failure) {
        throw Error(ExitCode::kRunFailed, "{}: cannot remove the incomplete last line: {}", path.string(),
                    failure.message());
    }
}

}  // namespace thimble
