// The parts that studies with the real programs share: folder, programs, scheduling.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thimble {

// A folder below that of temporary files; removed, with all that is in it, when this object goes. Throws Error (data).
class Scratch {
  public:
    Scratch();
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

// The folder of this program.
std::filesystem::path own_folder();

// Of --scheduling fifo, default or both: true is SCHED_FIFO, left out with a warning where it is not allowed. Throws Error
// (realtime) if nothing is left.
std::vector<bool> schedulings(const std::string& wanted);

}  // namespace thimble
