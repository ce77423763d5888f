// Motor, cable and finger pad in software: dead time, then an exact first-order lag, for each finger
//   tau df/dt = F(t - dead_time) - f,   0 <= F <= limit
// with the values of the device of the experiments as defaults (45 ms, 1.5 N; no lag).
#pragma once

#include <cstdint>
#include <vector>

#include "cutaneous_node/cutaneous_settings.hpp"
#include "cutaneous_node/fingertip_actuator.hpp"

namespace thimble {

class SimulatedActuator final : public FingertipActuator {
  public:
    explicit SimulatedActuator(const CutaneousSettings& settings);

    void command(SessionTime now, Finger finger, double force_N) override;
    // While one finger relaxes and the other is pressed already: the one that feels more.
    FingertipForce output(SessionTime now) override;
    // At once, without dead time: a real device cuts its motor current.
    void release(SessionTime now) override;
    // One hand's, without a life of its own, and nothing that fails.
    void use_hand(SessionTime /*now*/, Hand /*hand*/) override {}
    void tick(SessionTime /*now*/) override {}
    SessionTime next_wakeup() const override { return kNever; }
    std::string_view fault() const override { return {}; }

    // Commands replaced by a later one because too many came within one dead time.
    std::uint64_t coalesced() const { return coalesced_; }

  private:
    struct Target {
        SessionTime due{};
        SessionTime sample_time{};
        double force_N = 0;
        Finger finger = Finger::kNone;
    };
    struct Forces {
        double index_N = 0;
        double thumb_N = 0;
    };

    Forces forces_at(SessionTime now) const;
    void take_due_targets(SessionTime now);
    Target& waiting(std::size_t i) { return ring_[(first_ + i) & (ring_.size() - 1)]; }

    Duration dead_time_;
    double time_constant_s_;
    double limit_N_;
    std::vector<Target> ring_;  // size a power of two
    std::size_t first_ = 0;
    std::size_t count_ = 0;
    Target target_;  // in effect since target_.due
    Forces start_;   // at that moment
    std::uint64_t coalesced_ = 0;
};

}  // namespace thimble
