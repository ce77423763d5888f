// A mouse, a trackpad or a gamepad as the hand. The window's thread moves it, the node's thread asks where it is. Down, towards
// oneself, is into the tissue.
#pragma once

#include <atomic>

#include "visual_node/hand_flow.hpp"

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
    void move(double counts);
    // A gamepad's stick: `deflection` -1 to 1, held for `time`.
    void push(double deflection, Duration time);

    HandInput hand() const override { return {position_hand_m_, engaged_}; }
    void home() override { position_hand_m_ = 0; }

  private:
    static constexpr double kStickDeadBand = 0.15;
    static constexpr double kStickSpeed_m_per_s = 0.05;

    void shift(double way_m);

    double m_per_count_;
    std::atomic<double> position_hand_m_{0};
    std::atomic<bool> engaged_{false};
};

}  // namespace thimble
