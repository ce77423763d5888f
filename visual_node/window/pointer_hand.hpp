// A mouse, a trackpad or a gamepad as the hand. The window's thread moves it, the node's thread asks where it is. Down, towards
// oneself, is into the tissue.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>

#include "visual_node/person_flows.hpp"

namespace thimble {

class PointerHand final : public HandSource {
  public:
    // How far a hand reaches on either side of where a trial begins.
    static constexpr double kReach_m = 0.2;

    explicit PointerHand(double m_per_count) : m_per_count_(m_per_count) {}

    // The window's thread.
    void take_hold() { engaged_ = true; }
    void let_go() { engaged_ = false; }
    // A mouse has moved downwards by so many counts. Nothing happens while the hand has let go.
    void move(double counts) { shift(counts * m_per_count_); }
    // A gamepad's stick: `deflection` -1 to 1, held for `time`.
    void push(double deflection, Duration time) {
        if (!(std::abs(deflection) > kStickDeadBand)) return;
        shift(std::clamp(deflection, -1.0, 1.0) * kStickSpeed_m_per_s * to_seconds(time));
    }

    HandInput hand() const override { return {position_hand_m_, engaged_}; }
    void home() override { position_hand_m_ = 0; }

  private:
    static constexpr double kStickDeadBand = 0.15;
    static constexpr double kStickSpeed_m_per_s = 0.05;

    void shift(double way_m) {
        if (!engaged_ || !std::isfinite(way_m)) return;
        // The other thread may send it home meanwhile, which must not be undone.
        double from_m = position_hand_m_;
        while (!position_hand_m_.compare_exchange_weak(from_m,
                                                       std::clamp(from_m + way_m, -kReach_m, kReach_m))) {
        }
    }

    double m_per_count_;
    std::atomic<double> position_hand_m_{0};
    std::atomic<bool> engaged_{false};
};

}  // namespace thimble
