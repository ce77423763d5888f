// The needs of every loopback test: a folder and UDP ports of its own, and patience. These tests run on
// machines that may stall for a second: they wait for what must happen and never measure how fast it did.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/network_settings.hpp"
#include "common/time.hpp"
#include "tests/guarded_ports.hpp"
#include "tests/read_text.hpp"

namespace thimble {

// The one limit of every wait. Only a test that fails waits so long.
inline constexpr Duration kPatience = std::chrono::seconds{60};

// Polls; false if `limit` passed first.
bool wait_until(const std::function<bool()>& condition, Duration limit = kPatience);

// Removed, with all that is in it, when this object goes.
class Folder {
  public:
    Folder();
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    // A new file in it.
    std::filesystem::path write(const std::string& name, const std::string& text) const;

  private:
    std::filesystem::path path_;
};

// A command line: the words of `line`, which spaces part, and then `more`.
std::vector<std::string> words_in(const std::string& line, const std::vector<std::string>& more = {});

// Ports for a test of real programs, and a place of its own for their stops. From now on programs find no gnuplot.
class PortBlock : public GuardedPorts {
  public:
    PortBlock();
};

// Of tests that talk to programs, or listen to them, without protection.
inline const SecuritySettings kUnprotected{SecurityMode::kNone, false, {}, {}};
inline constexpr const char* kUnprotectedTable = "[security]\nmode = 'none'\n";
NetworkSettings network_at(std::uint16_t base_port, const SecuritySettings& security = kUnprotected);
// The table of a session file or of a node's settings. Makes the key, if it is not there.
std::string under_lab_key(const std::filesystem::path& key);

// The lines that a person types at a program: a pipe to its standard input.
class Typing {
  public:
    Typing();
    ~Typing();
    Typing(const Typing&) = delete;
    Typing& operator=(const Typing&) = delete;

    int input() const { return ends_[0]; }  // for the program
    void type(const std::string& lines) const;

  private:
    std::array<int, 2> ends_{-1, -1};
};

// A contact so long that the trial cannot end by itself while the test looks at it: by the wall clock, and in lock-step.
inline constexpr double kEndlessHold_s = 40, kEndlessInLockStep_s = 300;

// A session that is over quickly: the fixture close to the tissue, a short contact until the beep.
struct SessionFile {
    std::string modalities = R"(["HF"])";
    std::string delays_s = "[0.0]";  // empty: the file does not say
    double contact_hold_s = 0.5;     // the trial may take a minute more
    int parallel_conditions = 1;
    double peer_wait_s = 60;  // beside busy compilers and under sanitizers nodes need long to start
    std::string more;         // further tables

    // Leaves time to do something in the trial, which then goes on to its end.
    static SessionFile unhurried();
    static SessionFile endless(double contact_hold_s = kEndlessHold_s);
    std::string text() const;
};

}  // namespace thimble
