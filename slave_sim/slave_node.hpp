// The simulated slave: a needle in tissue before a virtual fixture. Pure logic, no clock: time is what the
// commands carry, on the master's clock.
//
// The tissue follows the smooth position of a command, whose slope is the estimated velocity: raw encoder
// steps would make the needle's velocity jump by more than the puncture force allows. The fixture, the proxy
// and the contact time follow the encoder's reading, undelayed.
#pragma once

#include <cstdint>

#include "common/messages.hpp"
#include "common/time.hpp"
#include "slave_sim/contact_timer.hpp"
#include "slave_sim/fixture.hpp"
#include "slave_sim/slave_settings.hpp"
#include "slave_sim/tissue.hpp"

namespace thimble {

class SlaveNode {
  public:
    // No command places the needle further from the origin; one that does (or is not a number, or is
    // from before the clock's origin) is refused.
    static constexpr double kFarthestNeedleMetres = 10;

    explicit SlaveNode(const SlaveSettings& settings);

    // Tissue at rest, fixture as ordered, no contact. The next command only sets the needle.
    void start_trial(const SessionControl& order);
    // Moves, removes or returns the fixture. Contact time goes on if the needle still touches it.
    void change_fixture(const SessionControl& order);
    // Outside a trial every force is zero.
    void end_trial();

    // One sample of the needle. The answer carries the sample's time and sequence; hold_time is the caller's
    // to fill. A refused command, or one that is not newer than the last, moves nothing and is answered with
    // the state as it was. After a gap longer than longest_step the needle is taken to have waited, then
    // moved within longest_step; contact starts anew.
    ForceFeedback on_needle(SessionTime sample_time, std::uint32_t sequence, const NeedleCommand& command);

    // Commands stopped: the needle is held where it is, every force is zero and contact is lost.
    ForceFeedback hold();

    // True exactly once after the beep became due.
    bool take_beep() {
        const bool due = beep_due_;
        beep_due_ = false;
        return due;
    }

    bool in_trial() const { return in_trial_; }
    // The tissue's transitions during the last command's step; offsets from the previous sample.
    const TissueEvents& events() const { return events_; }
    std::uint64_t refused() const { return refused_; }

  private:
    void follow(SessionTime sample_time, const NeedleCommand& command);
    void advance_tissue(SessionTime sample_time, double position_m);
    ForceFeedback answer() const;

    SlaveSettings settings_;
    Tissue tissue_;
    Fixture fixture_;
    ContactTimer timer_;
    TissueEvents events_;
    SessionTime sample_time_{};
    double position_needle_m_ = 0;
    std::uint64_t refused_ = 0;
    std::uint32_t sequence_ = 0;
    bool in_trial_ = false;
    bool needle_known_ = false;
    bool held_ = false;
    bool beep_due_ = false;
};

}  // namespace thimble
