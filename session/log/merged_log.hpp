// Messages of several programs in the order in which they happened: on the session's clock, by the offsets that its log holds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <vector>

#include "session/log/logged_file.hpp"

namespace thimble {

inline const LoggedFile* session_of(const std::vector<std::unique_ptr<LoggedFile>>& files) {
    const auto found = std::find_if(files.begin(), files.end(), [](const auto& file) {
        return file->value("thimble", "program") == "session";
    });
    return found == files.end() ? nullptr : found->get();
}

// "thimble-slave-sim" is slave_sim.
inline std::string role_of(const LoggedFile& file) {
    std::string name = file.value("thimble", "program");
    constexpr std::string_view kPrefix = "thimble-";
    if (name.starts_with(kPrefix)) name.erase(0, kPrefix.size());
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

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
    ClockOffsets(const std::vector<std::unique_ptr<LoggedFile>>& files, const LoggedFile& of) {
        const LoggedFile* session = session_of(files);
        if (session == nullptr || session == &of) return;
        const std::string boot = of.value("thimble", "machine_boot");
        if (!boot.empty() && boot == session->value("thimble", "machine_boot")) return;
        same_clock_ = false;
        for (const LogMetadata& record : session->metadata()) {
            if (record.name != "clock_offset" || value_of(record.pairs, "node") != role_of(of)) continue;
            const double offset_s =
                std::strtod(std::string(value_of(record.pairs, "offset_s")).c_str(), nullptr);
            if (!(std::abs(offset_s) < 1e9)) continue;  // longer than any machine has run
            const std::int64_t offset_ns = std::llround(offset_s * 1e9);
            const std::int64_t at_ns =
                std::strtoll(std::string(value_of(record.pairs, "at_ns")).c_str(), nullptr, 10);
            points_.push_back({static_cast<std::int64_t>(static_cast<std::uint64_t>(at_ns) +
                                                         static_cast<std::uint64_t>(offset_ns)),
                               offset_ns});
        }
        std::stable_sort(points_.begin(), points_.end(),
                         [](const Point& a, const Point& b) { return a.at_ns < b.at_ns; });
    }

    // As last measured; before the first time, as measured then.
    std::int64_t at(std::uint64_t time_ns) const {
        if (points_.empty()) return 0;
        const auto later =
            std::upper_bound(points_.begin(), points_.end(), static_cast<std::int64_t>(time_ns),
                             [](std::int64_t time, const Point& point) { return time < point.at_ns; });
        return later == points_.begin() ? later->offset_ns : std::prev(later)->offset_ns;
    }

    bool known() const { return same_clock_ || !points_.empty(); }

  private:
    struct Point {
        std::int64_t at_ns = 0, offset_ns = 0;  // `at` on the program's clock
    };
    bool same_clock_ = true;
    std::vector<Point> points_;  // in the order of time
};

// All of them, in memory as views of the files, which outlive them.
inline std::vector<MergedMessage> merge_logs(const std::vector<std::unique_ptr<LoggedFile>>& files) {
    std::vector<MergedMessage> all;
    std::size_t count = 0;
    for (const auto& file : files) count += file->scan().messages;
    all.reserve(count);
    for (const auto& file : files) {
        const ClockOffsets offsets(files, *file);
        file->for_each([&](const LoggedTopic& topic, const McapMessage& message) {
            const auto time =
                message.log_time_ns - static_cast<std::uint64_t>(offsets.at(message.log_time_ns));
            all.push_back({file.get(), &topic, message, static_cast<std::int64_t>(time)});
        });
    }
    std::stable_sort(all.begin(), all.end(), [](const MergedMessage& a, const MergedMessage& b) {
        return a.session_time_ns < b.session_time_ns;
    });
    return all;
}

}  // namespace thimble
