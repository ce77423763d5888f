// A needle that the mouse of a virtual screen moves, as far as its way is on the disk.
#pragma once

#include <cstdlib>
#include <functional>
#include <limits>
#include <string>

#include "tests/loopback/workbench.hpp"
#include "tests/window/virtual_screen.hpp"

namespace thimble {

// In the newest whole line of a trial under way; far outside where there is none yet.
inline double newest_needle_m(const std::filesystem::path& trajectory) {
    constexpr double kNone_m = -std::numeric_limits<double>::infinity();
    std::error_code absent;
    if (!std::filesystem::exists(trajectory, absent)) return kNone_m;
    const std::string text = read_text(trajectory);
    const std::size_t end = text.find_last_of('\n');
    if (end == std::string::npos || end == 0) return kNone_m;
    const std::size_t begin = text.find_last_of('\n', end - 1) + 1;
    const std::size_t comma = text.find(',', begin);
    if (begin == 1 || comma == std::string::npos) return kNone_m;
    return std::strtod(text.c_str() + comma + 1, nullptr);
}

// Moves the mouse by so many counts again and again, downwards if positive, until `done`.
inline bool move_until(const VirtualScreen& screen, int counts, const std::function<bool()>& done) {
    return wait_until([&] {
        if (done()) return true;
        screen.hand({"mousemove_relative", "--sync", "--", "0", std::to_string(counts)});
        return done();
    });
}

// A session file: a window of a slow machine opens later than a node answers.
inline std::string a_slow_window(const Folder& folder) {
    return folder.write("slow.toml", "[trial]\npeer_wait_s = 30\n").string();
}

}  // namespace thimble
