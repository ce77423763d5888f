// Errors that end a program: thrown at start-up or when a run cannot go on, caught once in main.
// A bad packet is not an error (it is counted), a bad program is asserted.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace thimble {

// For a terminal: a control character other than a line's end becomes '?', so that no text from a file or a peer can command it.
inline std::string printable(std::string text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        // U+0080 to U+009F, in two bytes of UTF-8, are commands too.
        const bool above =
            byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
        if (above) text.erase(i, 1);
        if (above || byte == 0x7F || (byte < 0x20 && byte != '\n' && byte != '\t')) text[i] = '?';
    }
    return text;
}

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
    // `what` says what happened, where, and what to do about it. It may quote any file or peer.
    Error(ExitCode code, std::string what) : std::runtime_error(printable(std::move(what))), code_(code) {}
    template <class First, class... More>
    Error(ExitCode code, fmt::format_string<First, More...> what, First&& first, More&&... more)
        : Error(code, fmt::format(what, std::forward<First>(first), std::forward<More>(more)...)) {}
    ExitCode code() const { return code_; }

  private:
    ExitCode code_ = ExitCode::kRunFailed;
};

}  // namespace thimble
