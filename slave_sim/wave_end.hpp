// The slave's end of wave variables: waves come in, the needle follows, waves go back (wave_variables.hpp). It has no period of
// its own: each of the master's samples moves it once, in order, whenever it comes; one that was lost and is not repeated
// either moves it as a wave of zero does, which costs the force and position, never passivity.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/control/wave_channel.hpp"
#include "common/control/wave_variables.hpp"
#include "common/messages.hpp"
#include "slave_sim/slave_settings.hpp"

namespace thimble {

inline constexpr double kRejoinStep_m = 1e-4;  // per sample, at the hand

inline WaveChannelSettings channel_of(const WaveEndSettings& settings) {
    WaveChannelSettings channel = settings.channel;
    channel.sample_period_s = to_seconds(settings.sample_period);
    return channel;
}

class WaveEnd {
  public:
    explicit WaveEnd(const WaveEndSettings& settings)
        : settings_(settings),
          slave_(
              {settings.impedance_Ns_per_m, to_seconds(settings.sample_period), settings.damping_Ns_per_m}),
          sender_(channel_of(settings)),
          receiver_(channel_of(settings)) {}

    // a trial begins
    void reset() {
        sender_.reset();
        receiver_.reset(0);
        burst_ = {};
        placed_ = astray_ = false;
    }

    // What a message brings; how many samples are to be stepped because of it. After more than kMostAtOnce missing ones
    // the older are left out, as if the slave had paused.
    std::uint32_t receive(const NeedleWave& message) {
        receiver_.receive(message.waves);
        const std::uint32_t number = message.waves.number;
        position_hand_m_ = message.command.position_hand_m;
        if (!placed_) {
            slave_.place(position_hand_m_);
            skip_to(number);
            placed_ = true;
        }
        if (number < next_) return 0;
        if (number - next_ >= kMostAtOnce) {
            skip_to(number - kMostAtOnce + 1);
            astray_ = true;
        }
        return number - next_ + 1;
    }

    // In the needle's frame: the plane (stiffness 0: none), and any other force on the operator (negative resists insertion)
    // as it was at the sample before. Where the needle is then.
    double step(double plane_needle_m, double stiffness_N_per_m, double other_force_N) {
        const double plane_hand_m = plane_needle_m / settings_.position_scale;
        const std::uint64_t missing = receiver_.missing();
        const double wave_root_W = receiver_.play(next_);
        astray_ = astray_ || receiver_.missing() > missing;
        if (astray_) rejoin(plane_hand_m);
        const WaveWall wall{plane_hand_m,
                            settings_.force_scale * settings_.position_scale * stiffness_N_per_m};
        const double back_root_W =
            slave_.step(wave_root_W, wall, -settings_.force_scale * other_force_N, settings_.force_limit_N);
        burst_ = sender_.add(back_root_W);
        ++next_;
        return settings_.position_scale * slave_.position_m();
    }

    const WaveBurst& burst() const { return burst_; }  // to go back
    Duration sample_period() const { return settings_.sample_period; }

    static constexpr std::uint32_t kMostAtOnce = 64;

  private:
    // Lost waves leave the needle elsewhere than the hand. Before the plane nothing is stored but what tissue does over the
    // gap: there it may go back, by 0.1 mm of hand at a time.
    void rejoin(double plane_hand_m) {
        if (std::max(slave_.position_m(), position_hand_m_) >= plane_hand_m) return;
        const double away_m = position_hand_m_ - slave_.position_m();
        slave_.place(slave_.position_m() + std::clamp(away_m, -kRejoinStep_m, kRejoinStep_m));
        astray_ = std::fabs(away_m) > kRejoinStep_m;
    }

    // The master counts by its own samples: what answers number n is number n.
    void skip_to(std::uint32_t number) {
        next_ = number;
        sender_.skip_to(number);
    }

    WaveEndSettings settings_;
    WaveSlave slave_;
    WaveSender sender_;
    WaveReceiver receiver_;
    WaveBurst burst_;
    double position_hand_m_ = 0;  // the master's newest
    std::uint32_t next_ = 0;      // sample
    bool placed_ = false, astray_ = false;
};

}  // namespace thimble
