#include "session/run/stop_file.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

std::filesystem::path folder_of_stops() {
    const std::string folder = environment_text("THIMBLE_STOP_DIR");
    return folder.empty() ? "/tmp" : folder;
}

std::string time_text() {
    const auto seconds = static_cast<std::time_t>(read_clock_pair().realtime_ns / 1'000'000'000);
    std::tm broken_down{};
    std::array<char, 64> text{};
    localtime_r(&seconds, &broken_down);
    std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S %Z", &broken_down);
    return text.data();
}

[[noreturn]] void fail_with(std::string_view what, const std::filesystem::path& path, std::string_view why) {
    throw Error(ExitCode::kRunFailed, "cannot {} {}: {}; this file keeps a stop (docs/safety.md)", what,
                path.string(), why);
}

[[noreturn]] void fail_with(std::string_view what, const std::filesystem::path& path, int error) {
    fail_with(what, path, std::strerror(error));
}

}  // namespace

StopFile::StopFile(std::uint16_t base_port)
    : base_port_(base_port),
      path_(folder_of_stops() / fmt::format("thimble-stop-{}-{}", geteuid(), base_port)) {}

// If another file has this path, no stop can be kept. The program reports that at the start, not at the stop.
std::optional<StopFile::Kept> StopFile::kept() const {
    const int file = open(path_.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    if (file < 0 && errno == ENOENT) return std::nullopt;
    if (file < 0) fail_with("read", path_, errno);
    struct stat status {};
    std::array<char, 1024> text{};
    const bool known = fstat(file, &status) == 0;
    const bool ours = known && S_ISREG(status.st_mode) && status.st_uid == geteuid();
    const ssize_t size = ours ? ::read(file, text.data(), text.size()) : 0;
    const int error = !known || size < 0 ? errno : 0;
    close(file);
    if (error != 0) fail_with("read", path_, error);
    if (!ours)
        fail_with("keep a stop in", path_,
                  "it does not belong to this user: remove it, or set THIMBLE_STOP_DIR");
    const std::int64_t written_ns =
        status.st_mtim.tv_sec * std::int64_t{1'000'000'000} + status.st_mtim.tv_nsec;
    return Kept{{text.data(), static_cast<std::size_t>(size)}, written_ns, status.st_ino};
}

void StopFile::require_released() const {
    const auto stop = kept();
    if (!stop) return;
    throw Error(ExitCode::kRunFailed,
                "a stop is active, so no session can begin: {}. When it is safe, release it: thimble stop "
                "--release --base-port {}",
                stop->words, base_port_);
}

// It follows no symbolic link of another user.
void StopFile::keep(std::string_view words) const {
    const int file = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (file < 0 && errno == EEXIST && kept()) return;
    if (file < 0) fail_with("write", path_, errno);
    const std::string text = fmt::format("{}, at {}", words, time_text());
    const bool written = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    const int error = errno;
    close(file);
    if (!written) fail_with("write", path_, error);  // the empty file holds as well
}

bool StopFile::release(const std::optional<Kept>& then) const {
    if (!then || kept() != then) return false;
    if (unlink(path_.c_str()) == 0) return true;
    if (errno != ENOENT) fail_with("remove", path_, errno);
    return false;
}

}  // namespace thimble
