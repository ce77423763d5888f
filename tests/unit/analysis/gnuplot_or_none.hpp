// Whether gnuplot is installed, and how to do without.
#pragma once

#include <cstdlib>
#include <string>

#include "common/error.hpp"
#include "common/process/child.hpp"

namespace thimble {

// A PATH of its own for as long as it lives.
class Path {
  public:
    explicit Path(const std::string& path) : before_(std::getenv("PATH")) {
        ::setenv("PATH", path.c_str(), 1);
    }
    ~Path() { ::setenv("PATH", before_.c_str(), 1); }
    Path(const Path&) = delete;
    Path& operator=(const Path&) = delete;

  private:
    std::string before_;
};

inline bool have_gnuplot() {
    try {
        return run_program("gnuplot", {"-V"}, ".", "").exit_code == 0;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace thimble
