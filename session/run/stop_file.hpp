// A stop that outlives its program. thimble leaves a file on its machine while a stop holds. It begins nothing on the
// same ports until "thimble stop --release" removes this file. The file is in
// THIMBLE_STOP_DIR, else in /tmp. A session over ssh and a service see the same folder there, unlike XDG_RUNTIME_DIR.
// One per user and base port, mode 0600.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace thimble {

class StopFile {
  public:
    explicit StopFile(std::uint16_t base_port);

    // Throws Error (run failed) with who stopped, why, when, and how to release it, if a stop is kept; also if none can be, because
    // something else has its place or cannot be read.
    void require_released() const;
    // `words`: who and why. Of several the first is kept. Throws Error (run failed) if it cannot be written.
    void keep(std::string_view words) const;
    // The kept stop, and the file's identity, which tells it from a later one. Throws Error (run failed) if the file
    // cannot be read.
    struct Kept {
        std::string words;
        std::int64_t written_ns = 0;
        std::uint64_t file = 0;
        bool operator==(const Kept&) const = default;
    };
    std::optional<Kept> kept() const;
    // Removes that kept stop and no later one. True if it did. Throws Error (run failed) if it cannot.
    bool release(const std::optional<Kept>& then) const;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::uint16_t base_port_;
    std::filesystem::path path_;
};

}  // namespace thimble
