// Progress of long work on stderr: one line that rewrites itself on a terminal, a plain line now and then
// elsewhere. The caller never waits for the terminal (standard_streams.hpp).
#pragma once

#include <string>
#include <unistd.h>

#include <boost/core/noncopyable.hpp>

#include "common/runtime/standard_streams.hpp"

namespace thimble {

class Progress : boost::noncopyable {
  public:
    Progress() : terminal_(isatty(STDERR_FILENO) != 0) {}
    // gives the terminal a moment: what the program says next, on stdout perhaps, stands behind
    ~Progress() { stderr_written_within(kBeforeResults); }
    // Shown at once on a terminal; elsewhere only if `milestone`.
    void show(const std::string& line, bool milestone) {
        if (terminal_) {
            write_stderr(kOverTheLine + line);
            open_ = true;
        } else if (milestone) {
            write_stderr(line + "\n");
        }
    }

    // A line that stays.
    void say(const std::string& line) {
        write_stderr((open_ ? kOverTheLine : "") + line + "\n");
        open_ = false;
    }

  private:
    static constexpr const char* kOverTheLine = "\r\033[K";
    static constexpr Duration kBeforeResults = std::chrono::milliseconds{500};

    bool terminal_;
    bool open_ = false;  // a rewritable line stands on the terminal
};

}  // namespace thimble
