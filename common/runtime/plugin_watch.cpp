#include "common/runtime/plugin_watch.hpp"

#include <unistd.h>
#include <utility>

#include "common/runtime/realtime_loop.hpp"

namespace thimble {
namespace {

// Ticks are counted, and no clock is read: while the program is stopped, neither thread runs.
constexpr Duration kTick = std::chrono::milliseconds{50};
// For the signal to print its line and to end the program.
constexpr Duration kToSayWhy = std::chrono::seconds{10};

}  // namespace

PluginWatch::PluginWatch() : place_(plugin_place()), watched_(pthread_self()), thread_([this] { watch(); }) {}

PluginWatch::~PluginWatch() {
    {
        const std::lock_guard guard(mutex_);
        over_ = true;
    }
    wakes_.notify_one();
    thread_.join();
}

void PluginWatch::expect(Duration limit, std::function<void()> rest) {
    const std::lock_guard guard(mutex_);
    ticks_allowed_ = static_cast<int>(limit / kTick);
    rest_ = std::move(rest);
}

void PluginWatch::watch() {
    block_signals();
    std::unique_lock guard(mutex_);
    while (!wakes_.wait_for(guard, kTick, [this] { return over_; }))
        if (hangs()) end_program();
}

// The same call at each of these ticks. From then on the watched thread does not leave it.
bool PluginWatch::hangs() {
    std::uint64_t call = place_.call;
    ticks_ = call != 0 && call == call_ ? ticks_ + 1 : 0;
    call_ = call;
    return ticks_ >= ticks_allowed_ && place_.call.compare_exchange_strong(call, PluginPlace::kGivenUp);
}

// The signal's handler names plug-in and function (controller_calls.cpp).
void PluginWatch::end_program() {
    if (rest_) rest_();
    pthread_kill(watched_, SIGXCPU);
    std::this_thread::sleep_for(kToSayWhy);
    _exit(kPluginHung);  // the plug-in blocks the signal
}

}  // namespace thimble
