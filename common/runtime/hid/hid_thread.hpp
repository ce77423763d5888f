// A HID device beside a node's loop, in a thread of its own: looking for it takes milliseconds, and a report to it waits for
// the device. Its user exchanges values with the loop, without blocking.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include <boost/core/noncopyable.hpp>

#include "common/hid/hid_connection.hpp"
#include "common/runtime/runtime_settings.hpp"

namespace thimble {

class HidThread : boost::noncopyable {
  public:
    // Starts at once, scheduled as the node's loop is: what is felt may come from here. `user` outlives this. Throws Error
    // as make_hidapi_bus().
    HidThread(HidUser& user, const RuntimeSettings& runtime);
    ~HidThread();

  private:
    void run(const RuntimeSettings& runtime);

    std::unique_ptr<HidBus> bus_;
    HidConnection connection_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace thimble
