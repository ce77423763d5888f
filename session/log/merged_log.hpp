// Messages of several programs in the order in which they happened: on the session's clock, by the offsets that its log holds.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "session/log/logged_file.hpp"

namespace thimble {

struct MergedMessage {
    const LoggedFile* file = nullptr;
    const LoggedTopic* topic = nullptr;
    McapMessage message;
    std::int64_t session_time_ns = 0;
};

// A program's clock minus the session's, at a moment of the program's clock, in ns. Zero for programs of one machine
// boot, which share a clock, and where no session's log is among the files.
class ClockOffsets {
  public:
    ClockOffsets(const std::vector<std::unique_ptr<LoggedFile>>& files, const LoggedFile& of);
    std::int64_t at(std::uint64_t time_ns) const;
    bool known() const { return same_clock_ || !points_.empty(); }

  private:
    struct Point {
        std::int64_t at_ns = 0, offset_ns = 0;  // `at` on the program's clock
    };
    bool same_clock_ = true;
    std::vector<Point> points_;  // in the order of time
};

// All of them, in memory as views of the files, which outlive them.
std::vector<MergedMessage> merge_logs(const std::vector<std::unique_ptr<LoggedFile>>& files);

}  // namespace thimble
