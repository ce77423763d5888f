// Errors that end a program: thrown at start-up or when a run cannot go on, caught once in main.
// A bad packet is not an error (it is counted), a bad program is asserted.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace thimble {

enum class ExitCode : int {
    kOk = 0,
    kRunFailed = 1,
    kUsage = 2,     // command line or configuration
    kNetwork = 3,   // port in use, peer missing or lost
    kRealtime = 4,  // deadline missed under --strict-rt
    kData = 5,      // a file that cannot be read or trusted
};

class Error : public std::runtime_error {
  public:
    // `what` says what happened, where, and what to do about it.
    Error(ExitCode code, const std::string& what) : std::runtime_error(what), code_(code) {}
    template <class First, class... More>
    Error(ExitCode code, fmt::format_string<First, More...> what, First&& first, More&&... more)
        : Error(code, fmt::format(what, std::forward<First>(first), std::forward<More>(more)...)) {}
    ExitCode code() const { return code_; }

  private:
    ExitCode code_ = ExitCode::kRunFailed;
};

}  // namespace thimble
