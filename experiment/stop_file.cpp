#include "experiment/stop_file.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

std::filesystem::path folder_of_stops() {
    const char* value = std::getenv("THIMBLE_STOP_DIR");  // NOLINT(concurrency-mt-unsafe): nobody sets it
    return value != nullptr && *value != '\0' ? value : "/tmp";
}

std::string time_in_words() {
    const auto seconds = static_cast<std::time_t>(read_clock_pair().realtime_ns / 1'000'000'000);
    std::tm broken_down{};
    std::array<char, 64> text{};
    localtime_r(&seconds, &broken_down);
    std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S %Z", &broken_down);
    return text.data();
}

[[noreturn]] void fail_with(std::string_view what, const std::filesystem::path& path, int error) {
    throw Error(ExitCode::kRunFailed, fmt::format("cannot {} {}: {}; a stop is kept there (docs/safety.md)",
                                                  what, path.string(), std::strerror(error)));
}

}  // namespace

StopFile::StopFile(std::uint16_t base_port)
    : base_port_(base_port),
      path_(folder_of_stops() / fmt::format("thimble-stop-{}-{}", geteuid(), base_port)) {}

std::optional<std::string> StopFile::read() const {
    struct stat status {};
    const bool ours =
        lstat(path_.c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == geteuid();
    if (!ours) return std::nullopt;
    std::ifstream file(path_);
    return std::string{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void StopFile::require_released() const {
    const auto words = read();
    if (!words) return;
    throw Error(ExitCode::kRunFailed, fmt::format("a stop holds and nothing begins: {}; once it is safe: "
                                                  "thimble stop --release --base-port {}",
                                                  *words, base_port_));
}

// Not through a link that somebody else has laid.
void StopFile::keep(std::string_view words) const {
    const int file = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (file < 0 && errno == EEXIST && read()) return;
    if (file < 0) fail_with("write", path_, errno);
    const std::string text = fmt::format("{}, at {}", words, time_in_words());
    const bool written = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    const int error = errno;
    close(file);
    if (!written) fail_with("write", path_, error);  // the empty file holds as well
}

std::optional<std::string> StopFile::release() const {
    auto words = read();
    if (words && unlink(path_.c_str()) != 0 && errno != ENOENT) fail_with("remove", path_, errno);
    return words;
}

}  // namespace thimble
