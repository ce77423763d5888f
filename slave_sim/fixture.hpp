// The virtual fixture: a stiff plane at z_vf that pushes back a needle beyond it.
//
// The god-object stays on the plane while the device point passes it, and the force is the spring between the
// two (C. B. Zilles and J. K. Salisbury, "A constraint-based god-object method for haptic display", IROS
// 1995). In one dimension: z_proxy = min(z_n, z_vf), force on the operator = -K (z_n - z_proxy).
#pragma once

namespace thimble {

struct FixtureParameters {
    double stiffness_N_per_m = 3000;  // per metre of needle travel
    double position_m = 0.123;        // along z, positive into the tissue
};

struct FixtureContact {
    double position_proxy_m;
    double penetration_m;  // beyond the fixture, positive inward; 0 without contact
    double force_N;        // on the operator, <= 0
};

class Fixture {
  public:
    explicit Fixture(const FixtureParameters& parameters) : parameters_(parameters) {}

    // Absent, the needle passes and the proxy goes with it.
    void place(double position_m, bool present) {
        parameters_.position_m = position_m;
        present_ = present;
    }
    bool present() const { return present_; }
    double position_m() const { return parameters_.position_m; }

    FixtureContact touch(double position_needle_m) const;

  private:
    FixtureParameters parameters_;
    bool present_ = true;
};

}  // namespace thimble
