// Ends a program whose plug-in does not come back. The session then reads the plug-in's name in the program's last words.
#pragma once

#include <condition_variable>
#include <csignal>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>

#include <boost/core/noncopyable.hpp>

#include "common/control/controller_calls.hpp"

namespace thimble {

// The exit code, as a shell has it, of a program that this watch has ended.
inline constexpr int kPluginHung = 128 + SIGXCPU;

// In real time the session gives a silent node up after kPeerTimeout, counted from its last heartbeat. The name comes before.
inline constexpr Duration kPluginLimit = std::chrono::milliseconds{400};
// In lock-step all programs wait, so a slow call changes no result. The limit only has to end a call that hangs.
inline constexpr Duration kPluginLimitInLockStep = std::chrono::seconds{2};
// Of destroy(), which may wait for a program to end.
inline constexpr Duration kPluginLimitAtEnd = std::chrono::seconds{2};

class PluginWatch : boost::noncopyable {
  public:
    // Watches the calls of the thread that makes it.
    PluginWatch();
    ~PluginWatch();
    // From now on; no call is watched before. `rest` takes the force off the device before the program ends.
    void expect(Duration limit, std::function<void()> rest = {});

  private:
    void watch();
    bool hangs();
    void end_program();

    PluginPlace& place_;
    pthread_t watched_;
    int ticks_allowed_ = std::numeric_limits<int>::max();
    std::function<void()> rest_;
    std::uint64_t call_ = 0;  // that the last tick saw, and since how many ticks
    int ticks_ = 0;
    std::mutex mutex_;
    std::condition_variable wakes_;
    bool over_ = false;
    std::thread thread_;
};

}  // namespace thimble
