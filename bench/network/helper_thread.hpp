// The other end of a measurement: a thread beside the one that is measured, and where they meet.
#pragma once

#include <arpa/inet.h>
#include <atomic>
#include <functional>
#include <sched.h>
#include <thread>
#include <utility>

#include "common/runtime/udp_socket.hpp"
#include "common/time.hpp"

namespace thimble {

inline UdpAddress loopback() { return {htonl(INADDR_LOOPBACK), 0}; }
inline double us(Duration duration) { return static_cast<double>(duration.count()) * 1e-3; }

// A helper must not inherit the real-time scheduling of the measured thread.
inline void be_ordinary() {
    const sched_param none{};
    sched_setscheduler(0, SCHED_OTHER, &none);
}

// A thread that runs until this object goes.
class Helper {
  public:
    explicit Helper(std::function<void(const std::atomic<bool>&)> work)
        : thread_([this, work = std::move(work)] { work(stop_); }) {}
    ~Helper() {
        stop_ = true;
        thread_.join();
    }

  private:
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace thimble
