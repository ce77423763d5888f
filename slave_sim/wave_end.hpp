// The slave's end of wave variables: waves come in, the needle follows, waves go back (wave_variables.hpp). It has no period of
// its own: each of the master's samples moves it once, in order, whenever it comes; one that was lost and is not repeated
// either moves it as a wave of zero does, which costs the force and position, never passivity.
#pragma once

#include "common/control/wave_channel.hpp"
#include "common/control/wave_variables.hpp"
#include "common/messages.hpp"
#include "slave_sim/slave_settings.hpp"

namespace thimble {

class WaveEnd {
  public:
    explicit WaveEnd(const WaveEndSettings& settings);

    void reset();  // a trial begins
    // What a message brings; how many samples are to be stepped because of it. After more than kMostAtOnce missing ones
    // the older are left out, as if the slave had paused.
    std::uint32_t receive(const NeedleWave& message);

    // In the needle's frame: the plane (stiffness 0: none), and any other force on the operator (negative resists insertion)
    // as it was at the sample before. Where the needle is then.
    double step(double plane_needle_m, double stiffness_N_per_m, double other_force_N);

    const WaveBurst& burst() const { return burst_; }  // to go back
    Duration sample_period() const { return settings_.sample_period; }

    static constexpr std::uint32_t kMostAtOnce = 64;

  private:
    // Lost waves leave the needle elsewhere than the hand. Before the plane nothing is stored but what tissue does over the
    // gap: there it may go back, by 0.1 mm of hand at a time.
    void rejoin(double plane_hand_m);
    void skip_to(std::uint32_t number);

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
