// A folder for logs: gone with this object, unless they are kept.
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
    void keep() { kept_ = true; }

  private:
    std::filesystem::path path_;
    bool kept_ = false;
};

}  // namespace thimble
