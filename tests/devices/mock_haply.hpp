// mock_haply.py as a child: a service of Haply's that behaves, or does not. Its words say how ("press=0.02", "fault=silent").
#pragma once

#include <string>
#include <vector>

#include "common/process/child.hpp"
#include "common/runtime/wall_clock.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {

class MockHaply {
  public:
    explicit MockHaply(const std::vector<std::string>& words = {})
        : child_("/usr/bin/python3", arguments(words), folder_ / "words") {
        const SessionTime end = wall_now() + std::chrono::seconds{20};
        while (!std::filesystem::exists(folder_ / "port") && wall_now() < end)
            wall_sleep(std::chrono::milliseconds{2});
        const std::string port = read_text(folder_ / "port");
        EXPECT_FALSE(port.empty()) << read_text(folder_ / "words");
        port_ = port.empty() ? 0 : static_cast<std::uint16_t>(std::stoi(port));
    }
    std::uint16_t port() const { return port_; }
    std::string log() const { return read_text(folder_ / "log"); }
    // For how long no message was read, each time that it was long; empty: never.
    std::string pauses() const { return read_text(folder_ / "pauses"); }
    // A moment may pass until the service has noticed an end.
    bool ends_with(const std::string& words) const {
        const SessionTime end = wall_now() + std::chrono::seconds{60};
        const auto there = [&] {
            const std::string text = log();
            return text.size() >= words.size() && text.substr(text.size() - words.size()) == words;
        };
        while (!there() && wall_now() < end) wall_sleep(std::chrono::milliseconds{2});
        return there();
    }
    // The hand goes in ("go") or out ("back"), the device is calibrated, or the fault begins.
    void make(const char* file) { write_text(folder_ / file, ""); }

  private:
    std::vector<std::string> arguments(const std::vector<std::string>& words) const {
        std::vector<std::string> all{"-B", THIMBLE_SOURCE_DIR "/tests/devices/mock_haply.py",
                                     folder_.path().string()};
        all.insert(all.end(), words.begin(), words.end());
        return all;
    }

    TemporaryDirectory folder_;
    Child child_;
    std::uint16_t port_ = 0;
};

}  // namespace thimble
