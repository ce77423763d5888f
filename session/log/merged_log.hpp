// Messages of several programs in the order in which they happened: on the session's clock, by the offsets that its log holds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.hpp"
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

// "out/run/nodes/50ms_trial02" of a log in lock-step, where instances are always the same, and sequences and clock begin anew with
// each trial. Empty: by the wall clock, or without the name that Thimble gave.
inline std::string lock_step_trial(const LoggedFile& file) {
    const std::string stem = file.path().stem().string();
    const std::size_t unit = stem.rfind("ms_trial"), delay = stem.rfind('_', unit);
    const bool named = unit != std::string::npos && delay != std::string::npos;
    if (!named || file.value("thimble", "monotonic_ns") != "0") return {};
    const std::filesystem::path path = std::filesystem::absolute(file.path()).lexically_normal();
    const std::size_t end = stem.find_first_not_of("0123456789", unit + std::string_view("ms_trial").size());
    return (path.parent_path() / stem.substr(delay + 1, end - delay - 1)).string();
}

// Throws Error (usage) for logs of several trials in lock-step, which have no clock in common.
inline void require_one_trial(const std::vector<std::unique_ptr<LoggedFile>>& files) {
    const LoggedFile* first = nullptr;
    for (const auto& file : files) {
        const std::string trial = lock_step_trial(*file);
        if (trial.empty()) continue;
        if (first == nullptr) first = file.get();
        const std::filesystem::path own = lock_step_trial(*first);
        if (trial != own)
            throw Error(ExitCode::kUsage,
                        "{} and {} are of different trials, and in lock-step each begins at 0 s: name the "
                        "logs of one, such as {}",
                        first->path().string(), file->path().string(),
                        (first->path().parent_path() / ("*_" + own.filename().string() + ".mcap")).string());
    }
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

// All of them, in memory as views of the files, which outlive them. Throws Error as require_one_trial().
inline std::vector<MergedMessage> merge_logs(const std::vector<std::unique_ptr<LoggedFile>>& files) {
    require_one_trial(files);
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
