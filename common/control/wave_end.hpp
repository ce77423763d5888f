// The slave's end of wave variables: waves come in, the needle follows, waves go back (wave_variables.hpp). It has no period of
// its own: each of the master's samples moves it once, in order, whenever it comes; one that was lost and is not repeated
// either moves it as a wave of zero does, which costs the force and position, never passivity.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/control/wave_channel.hpp"
#include "common/control/wave_variables.hpp"
#include "common/messages.hpp"

namespace thimble {

inline constexpr double kRejoinStep_m = 1e-4;  // per sample, at the hand

class WaveEnd {
  public:
    // Both with the same sample period.
    WaveEnd(const WaveSettings& waves, const WaveChannelSettings& channel, double force_limit_N)
        : slave_(waves), sender_(channel), receiver_(channel), force_limit_N_(force_limit_N) {}

    // a trial begins
    void reset() {
        sender_.reset();
        receiver_.reset(0);
        burst_ = {};
        placed_ = astray_ = false;
    }

    // Takes a message and returns how many samples to step. After more than kMostAtOnce missing samples the older
    // ones are skipped, as after a pause.
    std::uint32_t receive(double position_hand_m, const WaveBurst& waves) {
        receiver_.receive(waves);
        position_hand_m_ = position_hand_m;
        if (!placed_) {
            slave_.place(position_hand_m_);
            skip_to(waves.number);
            placed_ = true;
        }
        if (waves.number < next_) return 0;
        if (waves.number - next_ >= kMostAtOnce) {
            skip_to(waves.number - kMostAtOnce + 1);
            astray_ = true;
        }
        return waves.number - next_ + 1;
    }

    // Steps one sample: the plane (stiffness 0: none) and the other forces on the hand of the previous sample.
    // Returns the needle's place in the frame of the hand.
    double step_m(const WaveWall& plane, double other_hand_N) {
        const std::uint64_t missing = receiver_.missing();
        const double wave_root_W = receiver_.play(next_);
        astray_ = astray_ || receiver_.missing() > missing;
        if (astray_) rejoin(plane.position_m);
        burst_ = sender_.add(slave_.step(wave_root_W, plane, other_hand_N, force_limit_N_));
        ++next_;
        return slave_.position_m();
    }

    const WaveBurst& burst() const { return burst_; }  // to go back

    static constexpr std::uint32_t kMostAtOnce = 64;

  private:
    // Lost waves leave needle and hand apart. In front of the plane no elastic energy is stored, so there the needle
    // may return by 0.1 mm of hand motion per sample.
    void rejoin(double plane_hand_m) {
        if (std::max(slave_.position_m(), position_hand_m_) >= plane_hand_m) return;
        const double away_m = position_hand_m_ - slave_.position_m();
        slave_.place(slave_.position_m() + std::clamp(away_m, -kRejoinStep_m, kRejoinStep_m));
        astray_ = std::fabs(away_m) > kRejoinStep_m;
    }

    // Keeps the numbers of both ends equal: the answer to sample n has number n.
    void skip_to(std::uint32_t number) {
        next_ = number;
        sender_.skip_to(number);
    }

    WaveSlave slave_;
    WaveSender sender_;
    WaveReceiver receiver_;
    WaveBurst burst_;
    double force_limit_N_;
    double position_hand_m_ = 0;  // the master's newest
    std::uint32_t next_ = 0;      // sample
    bool placed_ = false, astray_ = false;
};

}  // namespace thimble
