#include "session/play/replay_clock.hpp"

#include <algorithm>
#include <cassert>

namespace thimble {

ReplayClock::ReplayClock(double duration_s, double speed)
    : duration_s_(duration_s), speed_(std::clamp(speed, kSlowest, kFastest)) {
    assert(duration_s >= 0);
}

double ReplayClock::time_s(SessionTime now) const {
    const double run_s = running_ ? speed_ * to_seconds(now - since_) : 0;
    return std::clamp(anchor_s_ + run_s, 0.0, duration_s_);
}

void ReplayClock::resume(SessionTime now) {
    if (running_) return;
    since_ = now;
    running_ = true;
}

void ReplayClock::pause(SessionTime now) {
    anchor_s_ = time_s(now);
    running_ = false;
}

void ReplayClock::seek(SessionTime now, double time_s) {
    anchor_s_ = std::clamp(time_s, 0.0, duration_s_);
    since_ = now;
}

void ReplayClock::set_speed(SessionTime now, double speed) {
    anchor_s_ = time_s(now);
    since_ = now;
    speed_ = std::clamp(speed, kSlowest, kFastest);
}

}  // namespace thimble
