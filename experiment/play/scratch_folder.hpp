// A folder for logs that nobody keeps: gone with this object.
#pragma once

#include <filesystem>

namespace thimble {

class ScratchFolder {
  public:
    // Throws Error (run failed) if the system's folder for such things cannot be written to.
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

}  // namespace thimble
