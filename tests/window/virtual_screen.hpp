// An X server without a monitor for tests with real windows, and a person's keys and mouse by xdotool. One for each test, so that a
// test may kill it. No other server has its number.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/process/child.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {

class VirtualScreen {
  public:
    // Starts Xvfb and lets DISPLAY name it. missing() says why there is none: then skip.
    VirtualScreen();
    ~VirtualScreen();
    VirtualScreen(const VirtualScreen&) = delete;
    VirtualScreen& operator=(const VirtualScreen&) = delete;

    const std::string& missing() const { return missing_; }
    // As a crash or a pulled cable: no goodbye.
    void kill();
    // For programs that a test starts.
    const Folder& folder() const { return folder_; }

    // Waits for a window with this in its title, and for its turn to hear keys.
    bool wait_for_window(const std::string& title);
    // One call of xdotool with these words, which are its own. False if it failed.
    bool hand(const std::vector<std::string>& words) const;
    bool type(const std::string& text) const { return hand({"type", "--delay", "60", text}); }
    bool press(const std::string& key) const { return hand({"key", key}); }
    // Again and again: a window that is slow to draw may miss one.
    bool press_until(const std::string& key, const std::function<bool()>& done) const;
    // A click of the left button in the window, pixels from its top left corner; held for some frames.
    bool click(int x, int y) const;
    bool resize(int width, int height) const;

  private:
    std::string first_line(const std::vector<std::string>& words) const;  // of xdotool; empty if that fails

    Folder folder_;
    std::optional<Child> server_;
    std::string number_, missing_, window_;
};

// A test with a screen of its own, which it may take away.
class OnAScreen : public testing::Test {
  protected:
    void SetUp() override {
        screen_.emplace();
        if (!screen_->missing().empty()) GTEST_SKIP() << screen_->missing();
    }

    std::optional<VirtualScreen> screen_;
};

}  // namespace thimble
