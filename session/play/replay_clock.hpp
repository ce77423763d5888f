// Where in a recording a replay is: runs at a speed, stands still, jumps. Time is an argument; it never goes beyond either end.
#pragma once

#include "common/time.hpp"

namespace thimble {

class ReplayClock {
  public:
    static constexpr double kSlowest = 0.01, kFastest = 100;

    // Stands at 0 until resume().
    explicit ReplayClock(double duration_s, double speed = 1);

    double time_s(SessionTime now) const;
    void resume(SessionTime now);
    void pause(SessionTime now);
    // Clipped to the recording, and to kSlowest to kFastest. Whether it runs stays as it is.
    void seek(SessionTime now, double time_s);
    void set_speed(SessionTime now, double speed);

    bool running() const { return running_; }
    bool at_end(SessionTime now) const { return time_s(now) >= duration_s_; }
    double speed() const { return speed_; }

  private:
    double duration_s_, speed_;
    double anchor_s_ = 0;  // in the recording, at since_
    SessionTime since_{};
    bool running_ = false;
};

}  // namespace thimble
