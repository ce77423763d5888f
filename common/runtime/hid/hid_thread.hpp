// A HID device beside a node's loop, in a thread of its own: looking for it takes milliseconds, and a report to it waits for
// the device. Its user exchanges values with the loop, without blocking.
#pragma once

#include <condition_variable>
#include <csignal>
#include <mutex>
#include <thread>

#include <boost/core/noncopyable.hpp>
#include <spdlog/spdlog.h>

#include "common/hid/hid_connection.hpp"
#include "common/hid/hid_link.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {

// HID devices by hidapi over hidraw: the HID drivers of Linux stay in place.

// Throws Error (usage) in a build without hidapi (THIMBLE_DEVICES=OFF).
std::unique_ptr<HidBus> make_hidapi_bus();

class HidThread : boost::noncopyable {
  public:
    // Starts at once, scheduled as the node's loop is: what is felt may come from here. `user` outlives this. Throws Error
    // as make_hidapi_bus().
    HidThread(HidUser& user, const RuntimeSettings& runtime)
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

    ~HidThread() {
        {
            const std::lock_guard lock(mutex_);
            stop_ = true;
        }
        wake_.notify_all();
        thread_.join();
    }

  private:
    void run(const RuntimeSettings& runtime) {
        ask_for_realtime(runtime);  // if it is refused the node's loop says so
        std::unique_lock lock(mutex_);
        while (!stop_) {
            lock.unlock();
            const Duration pause = connection_.step(wall_now());
            lock.lock();
            if (pause > Duration::zero()) wake_.wait_for(lock, pause, [this] { return stop_; });
        }
    }

    std::unique_ptr<HidBus> bus_;
    HidConnection connection_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace thimble
