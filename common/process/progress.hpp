// Progress of long work on stderr: one line that rewrites itself on a terminal, at most ten plain lines elsewhere.
// The caller never waits for the terminal (standard_streams.hpp).
#pragma once

#include <string>
#include <string_view>
#include <unistd.h>

#include <boost/core/noncopyable.hpp>
#include <fmt/format.h>

#include "common/runtime/standard_streams.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {

// "12 of 40 trials: 50 ms", the form of every count.
inline std::string progress_text(std::size_t done, std::size_t all, std::string_view things,
                                 std::string_view last) {
    return fmt::format("{} of {} {}{}{}", done, all, things, last.empty() ? "" : ": ", last);
}

class Progress : boost::noncopyable {
  public:
    Progress() : terminal_(isatty(STDERR_FILENO) != 0) {}
    // Waits briefly for the terminal, so that later output on stdout stands behind the progress.
    ~Progress() {
        close();
        stderr_written_within(kBeforeResults);
    }
    // Shown at once on a terminal; elsewhere only if `milestone`.
    void show(const std::string& line, bool milestone) {
        if (terminal_) {
            write_stderr(kOverTheLine + line);
            open_ = true;
        } else if (milestone) {
            write_stderr(line + "\n");
        }
    }

    // Seldom enough for a terminal. `last` describes the latest of the `done` things: "50 ms". The line of the last one stays.
    void count(std::size_t done, std::size_t all, std::string_view things, std::string_view last) {
        const SessionTime now = wall_now();
        if (terminal_ && done < all && now < next_count_) return;
        next_count_ = now + kBetweenCounts;
        const std::size_t tenths = 10 * done / all;
        show(progress_text(done, all, things, last), tenths > tenths_);
        tenths_ = done < all ? tenths : 0;
        if (done >= all) close();
    }

    // Ends the line that rewrites itself, before anything else is written.
    void close() {
        if (open_) write_stderr("\n");
        open_ = false;
    }

    // A line that stays.
    void say(const std::string& line) {
        write_stderr((open_ ? kOverTheLine : "") + line + "\n");
        open_ = false;
    }

  private:
    static constexpr const char* kOverTheLine = "\r\033[K";
    static constexpr Duration kBeforeResults = std::chrono::milliseconds{500};

    static constexpr Duration kBetweenCounts = std::chrono::milliseconds{100};

    bool terminal_;
    SessionTime next_count_{};
    bool open_ = false;       // a rewritable line stands on the terminal
    std::size_t tenths_ = 0;  // of the work, when the last plain line was written
};

}  // namespace thimble
