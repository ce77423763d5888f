#include "common/runtime/hid/hid_thread.hpp"

#include <csignal>

#include <spdlog/spdlog.h>

#include "common/runtime/hid/hidapi_bus.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {

HidThread::HidThread(HidUser& user, const RuntimeSettings& runtime)
    : bus_(make_hidapi_bus()), connection_(*bus_, user, [this](const std::string& sentence) {
          spdlog::log(connection_.attached() ? spdlog::level::info : spdlog::level::warn, sentence);
      }) {
    // Signals belong to the thread that the node's loop runs in.
    sigset_t all{}, before{};
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    thread_ = std::thread([this, runtime] { run(runtime); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

HidThread::~HidThread() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

void HidThread::run(const RuntimeSettings& runtime) {
    ask_for_realtime(runtime);  // if it is refused the node's loop says so
    std::unique_lock lock(mutex_);
    while (!stop_) {
        lock.unlock();
        const Duration pause = connection_.step(wall_now());
        lock.lock();
        if (pause > Duration::zero()) wake_.wait_for(lock, pause, [this] { return stop_; });
    }
}

}  // namespace thimble
