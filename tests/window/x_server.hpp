// An X server without a monitor, for tests with real windows: one per test, so that a test may kill it. No other has its number.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "common/process/child.hpp"

namespace thimble {

class XServer {
  public:
    // Starts Xvfb and lets DISPLAY name it. missing() says why there is none: then skip.
    XServer();
    ~XServer();
    XServer(const XServer&) = delete;
    XServer& operator=(const XServer&) = delete;

    const std::string& missing() const { return missing_; }
    // As a crash or a pulled cable: no goodbye.
    void kill();
    // For programs that a test starts.
    const std::filesystem::path& folder() const { return folder_; }

  private:
    std::filesystem::path folder_;
    std::optional<Child> server_;
    std::string number_;
    std::string missing_;
};

// A test with a server of its own.
class WithXServer : public testing::Test {
  protected:
    void SetUp() override {
        if (!server_.missing().empty()) GTEST_SKIP() << server_.missing();
    }

    XServer server_;
};

}  // namespace thimble
