// Where another thread asks the relaying thread to do something and waits until it has: the control socket's way in.
#pragma once

#include <atomic>
#include <exception>
#include <functional>

namespace thimble {

class RelayEngine;

class ControlHandler {
  public:
    using Job = std::function<void(RelayEngine&)>;

    ControlHandler();  // throws Error (run failed)
    ~ControlHandler();
    ControlHandler(const ControlHandler&) = delete;
    ControlHandler& operator=(const ControlHandler&) = delete;

    // Any thread but the relaying one, one at a time. False if the relaying thread did not take the job within two seconds. An exception of the job comes back to the caller.
    bool ask(const Job& job);

    // For the relaying thread: readable when a caller asks. Then serve() does the job.
    int descriptor() const { return event_; }
    void serve(RelayEngine& engine);

  private:
    struct Request {
        const Job* job;
        std::exception_ptr failure;
        std::atomic<bool> done{false};
    };
    std::atomic<Request*> waiting_{nullptr};
    int event_ = -1;
};

}  // namespace thimble
