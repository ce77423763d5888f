// Forbidden-region virtual fixture: a stiff plane that pushes back a needle beyond it.
//
// The god-object stays on the plane while the device point passes it, and the force is that of the spring and
// damper between the two (C. B. Zilles and J. K. Salisbury, "A constraint-based god-object method for haptic
// display", IROS 1995). In one dimension: z_proxy = min(z_n, z_vf), force on the operator
// -(K (z_n - z_vf) + B z_n') where z_n > z_vf, and never a pull.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "slave_sim/element.hpp"

namespace thimble {

// A sudden change, as in the paper's second experiment. One of the two triggers is set.
struct FixtureChange {
    std::optional<double> time_s;           // on the scene's clock
    std::optional<double> after_contact_s;  // of unbroken contact
    bool present = false;
    std::optional<double> position_m;  // stays where it is without
};

struct FixtureParameters {
    double stiffness_N_per_m = 3000;  // per metre of needle travel
    double damping_Ns_per_m = 0;
    double position_m = 0.123;           // along z, positive into the tissue
    std::vector<FixtureChange> changes;  // each waits for the one before
};

struct FixtureContact {
    double position_proxy_m;
    double penetration_m;  // beyond the fixture, positive inward; 0 without contact
    double force_N;        // on the operator, <= 0
};

class ForbiddenRegion final : public Element {
  public:
    explicit ForbiddenRegion(const FixtureParameters& parameters);

    // Moves, removes or returns the plane, also as the beginning of later trials. The needle is here; its
    // velocity counts from the next step on.
    void place(double position_m, bool present, double position_needle_m);
    bool present() const { return now_.present; }
    double position_m() const { return now_.position_m; }
    double stiffness_N_per_m() const { return parameters_.stiffness_N_per_m; }

    // Absent, the needle passes and the proxy goes with it.
    FixtureContact touch(double position_needle_m, double velocity_m_per_s = 0) const;

    void reset(double position_needle_m) override;
    void step(const NeedleStep& step, Transitions& transitions) override;
    double force_N() const override { return force_N_; }
    double rests_above_m() const override;

  private:
    struct Plane {
        double position_m;
        bool present;
    };

    bool beyond(double position_needle_m) const {
        return now_.present && position_needle_m > now_.position_m;
    }
    double flip_offset_s(const NeedleStep& step, double from_s) const;
    double change_offset_s(const NeedleStep& step, double from_s) const;
    void flip(const NeedleStep& step, double offset_s, Transitions& transitions);
    void apply(const FixtureChange& change, double offset_s, Transitions& transitions);

    FixtureParameters parameters_;
    Plane placed_;
    Plane now_;
    std::size_t next_change_ = 0;
    bool touching_ = false;
    double touching_since_s_ = 0;
    double force_N_ = 0;
};

}  // namespace thimble
