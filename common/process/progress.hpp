// Progress of long work on stderr: one line that rewrites itself on a terminal, a plain line now and then
// elsewhere. The caller never waits for the terminal (standard_streams.hpp).
#pragma once

#include <string>

#include <boost/core/noncopyable.hpp>

namespace thimble {

class Progress : boost::noncopyable {
  public:
    Progress();
    ~Progress();  // gives the terminal a moment: what the program says next, on stdout perhaps, stands behind
    // Shown at once on a terminal; elsewhere only if `milestone`.
    void show(const std::string& line, bool milestone);
    // A line that stays.
    void say(const std::string& line);

  private:
    bool terminal_;
    bool open_ = false;  // a rewritable line stands on the terminal
};

}  // namespace thimble
