// A handle with a thread of its own, driven by the wall clock as the master drives it. Tests look at what happens, in
// which order, and never at how fast.
#pragma once

#include <memory>
#include <string>

#include "common/runtime/wall_clock.hpp"
#include "master/devices/handle.hpp"

namespace thimble {

class LiveHandle {
  public:
    explicit LiveHandle(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}

    Handle& operator*() { return *handle_; }
    Handle* operator->() { return handle_.get(); }
    void reset() { handle_.reset(); }

    // Until the user has nothing to do; a trial with force begins.
    void begin() {
        until([this] { return handle_->awaits().empty(); });
        handle_->start_trial(wall_now(), {});
        handle_->enable_force(wall_now(), true);
    }
    // With this force, until `done` or 5 s have passed. Returns done().
    template <class Done>
    bool push(double force_hand_N, Done done) {
        return until([&] {
            sample = handle_->read(wall_now());
            handle_->command_force(wall_now(), force_hand_N);
            return done();
        });
    }
    bool ends(double force_hand_N) {
        return push(force_hand_N, [this] { return !handle_->fault().empty(); });
    }

    HandleSample sample;

  private:
    template <class Done>
    static bool until(Done done) {
        for (const SessionTime end = wall_now() + std::chrono::seconds{5}; wall_now() < end;) {
            if (done()) return true;
            wall_sleep(std::chrono::milliseconds{1});
        }
        return false;
    }

    std::unique_ptr<Handle> handle_;
};

}  // namespace thimble
