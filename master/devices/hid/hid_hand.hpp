// A SpaceMouse, joystick or gamepad as a person's hand. Two halves: HidHand talks to the device, in a thread of its own;
// HidHandle is the handle that the node reads, and asks the first for one number, never waiting.
#pragma once

#include <atomic>
#include <string_view>

#include "common/hid/hid_connection.hpp"
#include "master/devices/handle_settings.hpp"
#include "master/devices/hid/hid_axes.hpp"
#include "master/devices/pointer_handle.hpp"

namespace thimble {

class HidHand final : public HidUser {
  public:
    explicit HidHand(const HidHandSettings& settings) : settings_(settings) {}

    // Of the chosen axis, -1 to 1, positive into the tissue; none while no device is there. Any thread. A silent
    // device does not move: SpaceMouses report changes only.
    std::optional<double> deflection() const;
    // The button that the settings name is down, or has been since the last call. The node's thread.
    bool take_stop() { return stop_pressed_.exchange(false) || stop_down_; }
    std::uint64_t bad_reports() const { return bad_reports_.load(std::memory_order_relaxed); }
    std::uint64_t attachments() const { return attachments_.load(std::memory_order_relaxed); }

    std::optional<std::size_t> choose(const std::vector<HidDevice>& present, std::string& trouble) override;
    bool attach(const HidDevice& device, std::span<const std::uint8_t> descriptor,
                std::string& trouble) override;
    bool turn(SessionTime now, HidLink& link) override;
    // Some gamepads change by Bluetooth to reports of their maker's.
    std::string_view complaint() const override;
    void detach() override;

  private:
    void note_stop(bool down);

    HidHandSettings settings_;
    HidAxes axes_ = HidAxes::of_spacemouse();
    int others_ = 0;           // reports without an axis since attach(), up to kStrangeReports
    bool understood_ = false;  // one with an axis has come, or the model is known
    std::atomic<double> deflection_{kAbsent};
    std::atomic<bool> stop_down_{false};     // now
    std::atomic<bool> stop_pressed_{false};  // since the last take_stop()
    std::atomic<std::uint64_t> bad_reports_{0}, attachments_{0};

    static constexpr double kAbsent = 2;  // no deflection
};

// From deflections to where the hand wants the handle. Pure.
class HidMapping {
  public:
    explicit HidMapping(const HidHandSettings& settings) : settings_(settings) {}

    void start(SessionTime now);
    // `reach`: the largest distance from `position_hand_m` of a request, m. A request beyond it would have to come
    // back before it is felt.
    HandInput hand(SessionTime now, std::optional<double> deflection, double position_hand_m, double reach_m);

  private:
    double beyond_dead_zone(double deflection) const;

    HidHandSettings settings_;
    SessionTime reached_{};
    double wanted_m_ = 0;
};

// The simulated handle of a pointer, drawn by that hand: with force limits, friction and letting go as there. A device that is
// unplugged lets go at once; one that comes back takes the handle where it then is (kRate).
class HidHandle : public PointerHandle {
  public:
    // `hand` outlives it.
    HidHandle(const HandleSettings& handle, const HidHandSettings& settings, HidHand& hand);

    HandleSample read(SessionTime now) override;
    bool take_stop(SessionTime /*now*/) override { return hand_.take_stop(); }
    void start_trial(SessionTime now, const OperatorTask& task) override;
    HandFollower* follower() override { return nullptr; }

  private:
    HidMapping mapping_;
    HidHand& hand_;
    double reach_m_;
};

}  // namespace thimble
