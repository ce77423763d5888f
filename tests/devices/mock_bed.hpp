// Where devices that are not there stand: umockdev puts them into /sys and /dev of this process and of those it starts, and has
// their system calls answered here. Needs libumockdev-preload.so.0 in LD_PRELOAD.
#pragma once

#include <optional>
#include <string>
#include <umockdev.h>

#include <gtest/gtest.h>

namespace thimble {

class MockBed {
  public:
    // False: the library is not preloaded, and nothing here would be seen.
    static bool possible();

    MockBed();
    ~MockBed();
    MockBed(const MockBed&) = delete;
    MockBed& operator=(const MockBed&) = delete;

    // In umockdev's own words. Throws std::runtime_error, as the next.
    void add(const std::string& description);
    // Answers ioctl() on a file of /dev, until ignore().
    void answer(const std::string& file, UMockdevIoctlBase* handler);
    void ignore(const std::string& file);
    // Where a file of /dev really lies; nothing is there afterwards.
    std::string vacate(const std::string& file);
    UMockdevTestbed* testbed() { return testbed_; }

  private:
    UMockdevTestbed* testbed_;
};

// A test that needs such a bed; skipped where nothing on it would be seen. `Bed` stands while the test runs.
template <class Bed>
class OnABed : public testing::Test {
  protected:
    void SetUp() override {
        if (!MockBed::possible())
            GTEST_SKIP() << "libumockdev-preload.so.0 is not preloaded (package umockdev; ctest does it)";
        bed_.emplace();
    }
    std::optional<Bed> bed_;
};

}  // namespace thimble
