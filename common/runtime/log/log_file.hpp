// The file behind a log: whole records are appended, nothing else ever happens to it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/log/mcap_writer.hpp"

namespace thimble {

class LogFile final : public McapSink, boost::noncopyable {
  public:
    // Throws Error (usage) if there is such a file already, or if it cannot be created.
    explicit LogFile(const std::filesystem::path& path);
    ~LogFile();

    // Throws Error (run failed), in words for people, and leaves the file as it was before.
    void write(Bytes bytes) override;
    // In a file without a name, beside the log. False where there is none, or no room: then the writer keeps it in memory.
    bool set_aside(Bytes bytes) override;
    // Throws Error (run failed) if it cannot be read.
    void give_back(const std::function<void(Bytes)>& use) override;
    // Returns when the bytes are on the disk, as far as it can be asked for that. From any thread.
    void sync() const;

    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
    int aside_ = -1;
    std::vector<std::size_t> portions_;  // that were set aside
    std::uint64_t aside_size_ = 0;
};

}  // namespace thimble
