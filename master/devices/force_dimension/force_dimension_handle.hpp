// omega.3 and every other handle that Force Dimension's library opens. Its frame: x towards the user, y to the right, z up; the
// needle's axis and the other two are AxisConstraint's.
//
// All calls are made by the thread that reads the handle, as the SDK wants it: it exchanges one packet with the device in each
// (0.1 to 1 ms) and has no other way. In a trial with force every read() also applies the force anew: gravity compensation is
// computed in that call, the lateral spring needs it, and the device's watchdog stops the motors 31.9 ms after the last one.
#pragma once

#include <cstdint>
#include <string>

#include "common/velocity_estimator.hpp"
#include "master/devices/axis_constraint.hpp"
#include "master/devices/force_dimension/dhd_library.hpp"
#include "master/devices/handle.hpp"
#include "master/devices/handle_settings.hpp"

namespace thimble {

class ForceDimensionHandle final : public Handle {
  public:
    // How long the same cached position may come before the force is held at zero, in the second tick of 1 ms, and before the
    // device counts as stalled.
    static constexpr Duration kHeldAfter = std::chrono::microseconds{1500};
    static constexpr Duration kStalledAfter = std::chrono::milliseconds{20};
    // Short enough to see the shortest press of a button.
    static constexpr Duration kLookAgain = std::chrono::milliseconds{5};
    static constexpr unsigned kReadsPerStatus = 2;  // motors off within two ticks

    // Opens the device: the one with this serial number, else the only one. Throws Error: usage, if the library or the device is
    // not to be had, with what to do about it; run failed, if it is but waits for calibration, or refuses a setting.
    ForceDimensionHandle(const ForceDimensionSettings& settings, double force_limit_N, DhdLibrary library);
    ~ForceDimensionHandle() override;

    HandleSample read(SessionTime now) override;
    // A force that is not a number counts as zero.
    void command_force(SessionTime now, double force_hand_N) override;
    void enable_force(SessionTime now, bool enabled) override;
    std::string_view fault() const override { return fault_; }
    // Of the button that the settings name; asks the device, between trials too.
    bool take_stop(SessionTime now) override;
    SessionTime next_look() const override {
        return settings_.stop_button < 0 ? kNever : looked_ + kLookAgain;
    }

    std::string name() const override { return name_; }
    void describe(nlohmann::ordered_json& report) const override;

    std::uint64_t saturated() const { return saturated_; }  // forces that the motors could not give whole
    // Root mean square of the difference between the velocity of the SDK (20 ms window) and ours, along z.
    double velocity_difference_m_per_s() const;

  private:
    void open(int wanted_serial);
    int serial_of(int id) const;
    void prepare();
    std::string describe_status(const int* status) const;
    bool take_position(SessionTime now);
    void compare_velocities(SessionTime now);
    void watch_status();
    void apply();
    void fail(const std::string& what, const std::string& remedy);
    void fail_in(const char* function);
    std::string last_error() const;

    ForceDimensionSettings settings_;
    DhdLibrary library_;
    const DhdFunctions& dhd_;
    AxisConstraint axis_;
    double force_limit_N_;
    char id_ = -1;
    std::string name_, fault_;
    bool forced_ = false;  // force is enabled
    double force_hand_N_ = 0;
    SessionTime fresh_{};   // newest position that was not the last one again
    SessionTime looked_{};  // at the button
    bool heard_ = false;
    bool held_ = false;  // no force: the position is too old
    unsigned reads_until_status_ = kReadsPerStatus;
    VelocityEstimator velocity_;
    std::uint64_t reads_ = 0, held_reads_ = 0, saturated_ = 0, compared_ = 0;
    double squared_difference_ = 0;
};

}  // namespace thimble
