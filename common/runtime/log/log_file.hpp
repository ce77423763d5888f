// The file behind a log: whole records are appended, nothing else ever happens to it.
#pragma once

#include <cstdint>
#include <filesystem>

#include "common/log/mcap_writer.hpp"

namespace thimble {

class LogFile final : public McapSink {
  public:
    // Throws Error (usage) if there is such a file already, or if it cannot be created.
    explicit LogFile(const std::filesystem::path& path);
    ~LogFile();
    LogFile(const LogFile&) = delete;
    LogFile& operator=(const LogFile&) = delete;

    // Throws Error (run failed), in words for people, and leaves the file as it was before.
    void write(Bytes bytes) override;
    // Returns when the bytes are on the disk, as far as it can be asked for that. From any thread.
    void sync() const;

    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

}  // namespace thimble
