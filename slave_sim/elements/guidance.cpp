// [guidance]: a guidance fixture, which draws the needle to a depth from both sides.
//
// A spring and a damper to the target, force on the operator -(K (z_n - z_g) + B z_n'): the one-dimensional
// case of guidance along a path (J. J. Abbott, P. Marayong and A. M. Okamura, "Haptic virtual fixtures for
// robot-assisted manipulation", Robotics Research, 2007).
#include "slave_sim/element_types.hpp"

namespace thimble {

namespace {

struct GuidanceParameters {
    double stiffness_N_per_m = 50;
    double damping_Ns_per_m = 0;
    double position_m = 0.1;
};

class Guidance final : public Element {
  public:
    explicit Guidance(const GuidanceParameters& parameters) : parameters_(parameters) {}

    void reset(double position_needle_m) override { feel(position_needle_m, 0); }
    void step(const NeedleStep& step, Transitions& /*transitions*/) override {
        feel(step.to_m, step.velocity_m_per_s);
    }
    double force_N() const override { return force_N_; }

  private:
    void feel(double position_needle_m, double velocity_m_per_s) {
        force_N_ = -(parameters_.stiffness_N_per_m * (position_needle_m - parameters_.position_m) +
                     parameters_.damping_Ns_per_m * velocity_m_per_s);
    }

    GuidanceParameters parameters_;
    double force_N_ = 0;
};

}  // namespace

void read_guidance(const ConfigTable& table, const std::string& name, SceneDeclaration& scene) {
    GuidanceParameters p;
    table.read("stiffness_N_per_m", p.stiffness_N_per_m, 0, 1e12,
               "Stiffness of the spring towards the depth, in both directions.");
    table.read("damping_Ns_per_m", p.damping_Ns_per_m, 0, 1e9, "Damping, times the estimated velocity.");
    table.read("position_m", p.position_m, -1, 1, "Depth towards which the fixture pulls.");
    const auto make = [p](const TissueMaker&) { return std::make_unique<Guidance>(p); };
    scene.elements.push_back({name, ElementKind::kFixture, p.position_m, make});
}

}  // namespace thimble
