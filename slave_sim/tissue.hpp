// Needle and tissue in one dimension: a hybrid automaton stepped exactly.
//
// One axis z, positive into the tissue; SI units. z_n needle tip, z_t surface, x = z_t - rest position; K, B,
// M stiffness, damping and mass of the tissue, V drag of the needle beneath the surface, F_p puncture force.
//
//   phase        motion of the surface                          force on the operator
//   free         M x'' = -K x - B x'                            0
//   contact      z_t = z_n, z_t' = z_n'                         -f,  f = K x + B z_n'
//   penetrated   M x'' = -K x - B x' - V (z_t' - z_n')          -V (z_n' - z_t')
//
//   free -> contact        the gap z_n - z_t reaches 0 while closing (inelastic: z_t' becomes z_n')
//   contact -> penetrated  f > F_p
//   contact -> free        f < 0
//   penetrated -> free     the gap reaches 0 while the needle leaves
//
// Forces act on the operator: negative resists insertion. The needle moves linearly within a step and its
// velocity jumps between steps; phase, surface and force after a step are left limits, with the velocity of
// that step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/messages.hpp"
#include "slave_sim/second_order.hpp"

namespace thimble {

struct TissueParameters {
    double mass_kg = 1;              // > 0
    double stiffness_N_per_m = 2;    // >= 0
    double damping_Ns_per_m = 5;     // >= 0
    double drag_Ns_per_m = 0.7;      // >= 0
    double puncture_force_N = 0.1;   // > 0
    double rest_position_m = 0.020;  // of the surface
};

struct TissueState {
    TissuePhase phase = TissuePhase::kFree;
    double position_surface_m = 0;
    double velocity_surface_m_per_s = 0;
    double force_N = 0;  // on the operator
};

struct TissueEvent {
    double offset_s;    // from the start of the step
    TissuePhase phase;  // entered
};

// The transitions of one step in order; several can share one instant (a fast needle touches and pierces at
// once).
class TissueEvents {
  public:
    static constexpr std::size_t kCapacity = 16;

    void clear() { size_ = 0; }
    void push(const TissueEvent& event) {
        if (size_ < kCapacity) {
            events_[size_++] = event;
        } else {
            ++overflows_;
        }
    }
    std::size_t size() const { return size_; }
    const TissueEvent& operator[](std::size_t i) const { return events_[i]; }
    const TissueEvent* begin() const { return events_.data(); }
    const TissueEvent* end() const { return events_.data() + size_; }
    std::uint64_t overflows() const { return overflows_; }  // events that found no room, ever

  private:
    std::array<TissueEvent, kCapacity> events_{};
    std::size_t size_ = 0;
    std::uint64_t overflows_ = 0;
};

class Tissue {
  public:
    explicit Tissue(const TissueParameters& parameters);

    // Surface at rest. A needle that starts beneath it is in the tissue, on or above it free.
    void reset(double position_needle_m);

    // Moves the needle on a straight line to `position_needle_m`. Appends the transitions to `events`.
    // duration >= 0; zero leaves everything as it is: without time nothing moves.
    void step(double duration_s, double position_needle_m, TissueEvents& events);

    TissueState state() const;
    double position_needle_m() const { return parameters_.rest_position_m + needle_m_; }

    // Steps with 64 transitions in a millionth of their time, which ended without looking for more.
    std::uint64_t unresolved_steps() const { return unresolved_steps_; }

  private:
    struct Leg;

    bool contact_leg(Leg& leg);
    bool moving_leg(Leg& leg);
    double crossing(const Leg& leg, const SecondOrder& law, const Propagator& p, double acceleration) const;
    double contact_force_N(double needle_m, double velocity_m_per_s) const {
        return parameters_.stiffness_N_per_m * needle_m + parameters_.damping_Ns_per_m * velocity_m_per_s;
    }
    double beyond_s(double limit_N, double side, const Leg& leg) const;
    void enter(TissuePhase phase, double after_s, Leg& leg);

    TissueParameters parameters_;
    std::array<SecondOrder, 2> laws_;     // of the surface alone, and with the needle in it
    std::array<Propagator, 2> cached_{};  // for the duration of the last step
    TissuePhase phase_ = TissuePhase::kFree;
    // Needle and surface relative to the surface's rest position.
    double needle_m_ = 0;
    double surface_m_ = 0;
    double velocity_needle_m_per_s_ = 0;
    double velocity_surface_m_per_s_ = 0;
    std::uint64_t unresolved_steps_ = 0;
};

}  // namespace thimble
