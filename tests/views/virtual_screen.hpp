// An X server without a screen for tests with real windows, and a person's keys and mouse by xdotool.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/loopback/workbench.hpp"
#include "tests/window/x_server.hpp"

namespace thimble {

// The reason to skip such tests on this machine; empty: none.
std::string missing_for_windows();

class VirtualScreen {
  public:
    // False if the server did not come up.
    bool ready() const { return server_.missing().empty(); }
    // Waits for a window with this in its title, and for its turn to hear keys.
    bool wait_for_window(const std::string& title);
    // One call of xdotool with these words, which are its own. False if it failed.
    bool hand(const std::vector<std::string>& words) const;
    bool type(const std::string& text) const { return hand({"type", "--delay", "60", text}); }
    bool press(const std::string& key) const { return hand({"key", key}); }
    // A click of the left button in the window, pixels from its top left corner; held for some frames.
    bool click(int x, int y) const;
    bool resize(int width, int height) const;

  private:
    XServer server_;
    Folder folder_;
    std::string window_;
};

// A test with a screen of its own, which it may take away.
class OnAScreen : public testing::Test {
  protected:
    void SetUp() override {
        if (const std::string missing = missing_for_windows(); !missing.empty()) GTEST_SKIP() << missing;
        screen_.emplace();
        ASSERT_TRUE(screen_->ready());
    }

    std::optional<VirtualScreen> screen_;
};

}  // namespace thimble
