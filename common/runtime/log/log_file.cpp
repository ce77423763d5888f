#include "common/runtime/log/log_file.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

// About as long as DeviceFault has room for, because the words go behind a heartbeat. The end of a path says more than its beginning.
std::string short_path(const std::filesystem::path& path) {
    constexpr std::size_t kMost = 120;
    const std::string text = path.string();
    return text.size() <= kMost ? text : "..." + text.substr(text.size() - kMost);
}

// -1 if the folder allows none.
int open_nameless(const std::filesystem::path& beside) {
    std::string name = (beside.parent_path() / ".thimble-index-XXXXXX").string();
    const int descriptor = mkostemp(name.data(), O_CLOEXEC);
    if (descriptor >= 0) unlink(name.c_str());
    return descriptor;
}

}  // namespace

LogFile::LogFile(const std::filesystem::path& path) : path_(path) {
    refuse_folder(path);
    descriptor_ = open_to_write(path, O_EXCL);
    if (descriptor_ < 0 && errno != EEXIST) fail_to_create(path, errno);
    if (descriptor_ < 0) {
        throw Error(ExitCode::kUsage,
                    "cannot create the log '{}': {}; a log is never overwritten: name another file",
                    path.string(), std::strerror(errno));
    }
    aside_ = open_nameless(path);
}

LogFile::~LogFile() {
    close(descriptor_);
    if (aside_ >= 0) close(aside_);
}

// The next write replaces an incomplete one.
bool LogFile::set_aside(Bytes bytes) {
    std::size_t done = 0;
    while (aside_ >= 0 && done < bytes.size()) {
        const auto wrote =
            pwrite(aside_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(aside_size_ + done));
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote <= 0) return false;
        done += static_cast<std::size_t>(wrote);
    }
    if (aside_ < 0) return false;
    portions_.push_back(bytes.size());
    aside_size_ += bytes.size();
    return true;
}

void LogFile::give_back(const std::function<void(Bytes)>& use) {
    std::vector<std::uint8_t> portion;
    std::uint64_t at = 0;
    for (const std::size_t size : portions_) {
        portion.resize(size);
        for (std::size_t done = 0; done < size;) {
            const auto got = pread(aside_, portion.data() + done, size - done, static_cast<off_t>(at + done));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) {
                throw Error(ExitCode::kRunFailed,
                            "the log '{}' has no index, because it cannot be read back ({}); 'thimble log "
                            "repair' makes one",
                            short_path(path_), got == 0 ? "it has become shorter" : std::strerror(errno));
            }
            done += static_cast<std::size_t>(got);
        }
        at += size;
        use(portion);
    }
}

void LogFile::write(Bytes bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const auto wrote = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
        if (wrote > 0) {
            done += static_cast<std::size_t>(wrote);
        } else if (wrote == 0 || errno != EINTR) {
            const int error = wrote == 0 ? ENOSPC : errno;
            // Half a record would be in the way of what may still fit.
            static_cast<void>(::ftruncate(descriptor_, static_cast<off_t>(size_)) == 0);
            lseek(descriptor_, static_cast<off_t>(size_), SEEK_SET);
            throw Error(ExitCode::kRunFailed,
                        "the log '{}' cannot be written: {}; free disk space or name another folder, and "
                        "start again. Its earlier messages can still be read",
                        short_path(path_), std::strerror(error));
        }
    }
    size_ += bytes.size();
}

// An error here is one of the next write, too, or of a file that cannot be synchronised.
void LogFile::sync() const { static_cast<void>(::fdatasync(descriptor_) == 0); }

}  // namespace thimble
