// A compensator at one port: between the force that the network brings and the handle, once per sample, knowing only where the
// hand is and which force acted. Tick k:
//     observe(dt, x_k, F_{k-1})     what the last force has done
//     force_N(wanted)               F_k, held until the next sample; may be asked again with a newer request
// F positive pushes the hand out (-z). SI units, frame: hand.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <boost/core/noncopyable.hpp>

namespace thimble {

struct PortSettings {
    double sample_period_s = 1e-3;         // h, > 0
    double device_damping_Ns_per_m = 0.5;  // b_d: of the handle, or whatever is certain to be there; >= 0
};

class PortCompensator : boost::noncopyable {
  public:
    explicit PortCompensator(const PortSettings& settings) : settings_(settings) {}
    virtual ~PortCompensator() = default;

    // A trial begins: nothing known, nothing stored.
    void reset() {
        placed_ = blind_ = false;
        refused_ = 0;
        clear();
    }

    // elapsed_s: since the previous sample. A late sample is credited with no more damping than it can have had. A
    // sample that is not a number, or not later than the previous one, is refused. The force is zero until the next
    // good one, and that gap adds no stored energy.
    void observe(double elapsed_s, double position_hand_m, double force_held_N) {
        const bool timely = !placed_ || (std::isfinite(elapsed_s) && elapsed_s > 0);
        if (!timely || !std::isfinite(position_hand_m) || !std::isfinite(force_held_N)) {
            ++refused_;
            blind_ = true;
            lose();
            return;
        }
        // After a gap the force along the way is unknown, so that way is not accounted for.
        if (placed_ && !blind_)
            take(position_hand_m - position_hand_m_, std::max(elapsed_s, settings_.sample_period_s),
                 force_held_N);
        placed_ = true;
        blind_ = false;
        position_hand_m_ = position_hand_m;
    }

    // A request that is not a number counts as none, 0.
    double force_N(double wanted_N) {
        if (!std::isfinite(wanted_N)) {
            ++refused_;
            wanted_N = 0;
        }
        return placed_ && !blind_ ? answer(wanted_N) : 0;
    }

    std::uint64_t refused() const { return refused_; }

  protected:
    const PortSettings& settings() const { return settings_; }

  private:
    virtual void clear() = 0;
    // The hand went travel_hand_m in period_s >= h against force_N.
    virtual void take(double travel_hand_m, double period_s, double force_N) = 0;
    virtual void lose() = 0;  // a sample is missing
    virtual double answer(double wanted_N) const = 0;

    PortSettings settings_;
    bool placed_ = false, blind_ = false;
    double position_hand_m_ = 0;
    std::uint64_t refused_ = 0;
};

}  // namespace thimble
