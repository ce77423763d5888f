// Motor, cable and finger pad in software: dead time, then an exact first-order lag, for each finger
//   tau df/dt = F(t - dead_time) - f,   0 <= F <= limit
// with the values of the device of the experiments as defaults (45 ms, 1.5 N; no lag).
#pragma once

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <vector>

#include "common/math/portable.hpp"
#include "cutaneous_node/cutaneous_settings.hpp"
#include "cutaneous_node/fingertip_actuator.hpp"

namespace thimble {

// Commands of one dead time at the shortest sample period of a session; what comes faster is coalesced.
inline std::size_t ring_size(Duration dead_time) {
    const auto in_flight = static_cast<std::size_t>(dead_time / std::chrono::microseconds{100});
    return std::bit_ceil(in_flight + 8);
}

class SimulatedActuator final : public FingertipActuator {
  public:
    explicit SimulatedActuator(const CutaneousSettings& settings)
        : dead_time_(settings.dead_time),
          time_constant_s_(to_seconds(settings.time_constant)),
          limit_N_(settings.force_limit_N),
          ring_(ring_size(settings.dead_time)) {
        assert(settings.dead_time >= Duration::zero() && settings.time_constant >= Duration::zero());
        assert(settings.force_limit_N > 0);
    }

    void command(SessionTime now, Finger finger, double force_N) override {
        take_due_targets(now);
        if (count_ == ring_.size()) --count_;  // the later command replaces the one before it
        // Written so that a NaN is no force.
        const bool pressed = finger != Finger::kNone && force_N > 0;
        waiting(count_++) = {now + dead_time_, now, pressed ? std::min(force_N, limit_N_) : 0.0, finger};
    }

    // The finger with the larger force: one may still relax while the other is pressed.
    FingertipForce output(SessionTime now) override {
        take_due_targets(now);
        const Forces force = forces_at(now);
        const double strongest_N = std::max(force.index_N, force.thumb_N);
        if (strongest_N < kSlack_N) return {Finger::kNone, 0, target_.sample_time};
        const Finger finger = force.index_N >= force.thumb_N ? Finger::kIndex : Finger::kThumb;
        return {finger, strongest_N, target_.sample_time};
    }

    // At once, without dead time: a real device cuts its motor current.
    void release(SessionTime now) override {
        count_ = 0;
        target_ = {now, now, 0, Finger::kNone};
        start_ = {};
    }

    // A simulated device has no messages, no second hand and no faults.
    void use_hand(SessionTime /*now*/, Hand /*hand*/) override {}
    void tick(SessionTime /*now*/) override {}
    SessionTime next_wakeup() const override { return kNever; }
    std::string_view fault() const override { return {}; }

  private:
    // A lag never quite reaches zero; below this the cable counts as slack.
    static constexpr double kSlack_N = 1e-6;

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

    // Exact, and always from the last change of target: asking more often does not change the answer.
    Forces forces_at(SessionTime now) const {
        const Forces goal{target_.finger == Finger::kIndex ? target_.force_N : 0,
                          target_.finger == Finger::kThumb ? target_.force_N : 0};
        if (time_constant_s_ == 0) return goal;
        const double rest = portable::exp(-to_seconds(now - target_.due) / time_constant_s_);
        return {goal.index_N + (start_.index_N - goal.index_N) * rest,
                goal.thumb_N + (start_.thumb_N - goal.thumb_N) * rest};
    }

    void take_due_targets(SessionTime now) {
        while (count_ > 0 && waiting(0).due <= now) {
            start_ = forces_at(waiting(0).due);
            target_ = waiting(0);
            ++first_;
            --count_;
        }
    }

    Target& waiting(std::size_t i) { return ring_[(first_ + i) & (ring_.size() - 1)]; }

    Duration dead_time_;
    double time_constant_s_;
    double limit_N_;
    std::vector<Target> ring_;  // size a power of two
    std::size_t first_ = 0;
    std::size_t count_ = 0;
    Target target_;  // in effect since target_.due
    Forces start_;   // at that moment
};

}  // namespace thimble
