// A needle that a robot somewhere moves: it sends where the needle is and what it feels, and obeys places. This half is pure; a subclass
// brings the messages (ros2_needle.hpp).
//
// No place is sent before the robot's own is known. From there the needle goes to the commanded place, first at
// kRamp_m_per_s, and within the robot's limits. When commands stop, it is held where it then is; kSaysHold after the
// trial the sender falls silent. While an input is stale, no new place is sent and nothing is felt. A place that
// comes back after a hold is the one that is held. A lost input, or a second program that sends one, ends the trial.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/remote_input.hpp"
#include "slave_sim/slave_settings.hpp"

namespace thimble {

class RemoteNeedle {
  public:
    static constexpr double kRamp_m_per_s = 0.05;
    static constexpr double kMostForce_N = 1000;  // no needle survives more: the number is wrong
    static constexpr Duration kSignOfLife = std::chrono::milliseconds{10};
    static constexpr Duration kSaysHold = std::chrono::milliseconds{300};

    explicit RemoteNeedle(const RobotLimits& limits) : limits_(limits) {}
    RemoteNeedle(const RemoteNeedle&) = delete;
    RemoteNeedle& operator=(const RemoteNeedle&) = delete;
    virtual ~RemoteNeedle() = default;

    // As at Handle: empty once the robot is ready.
    virtual std::string awaits() = 0;
    virtual std::string name() const = 0;

    void start_trial(SessionTime now) {
        position_.start_trial(now);
        force_.start_trial(now);
        fault_.clear();
        target_m_.reset();
        told_ = kNever;
        following_ = false;
        silent_at_ = kNever;
    }
    void end_trial(SessionTime now) {
        hold(now);
        silent_at_ = now + kSaysHold;
    }
    // Takes all messages. Call it at each tick.
    void hear(SessionTime now);
    // Commands a place for the needle, m; finite.
    void command(SessionTime now, double position_m);
    // Commands have stopped.
    void hold(SessionTime now);
    // Sends the held place again; false: there is none to send.
    bool repeat_hold(SessionTime now);

    // Both inputs are fresh, so the needle can be followed and felt.
    bool is_felt() const { return knows_place() && force_.placed() && !force_.stale() && fault_.empty(); }
    double position_m() const { return position_.value(); }
    double force_N() const {
        return std::clamp(force_.value(), -limits_.force_limit_N, limits_.force_limit_N);
    }
    SessionTime next_look() const {
        return silent_at_ == kNever || heard_ < silent_at_ ? heard_ + kSignOfLife : kNever;
    }
    std::string_view fault() const { return fault_; }
    virtual void describe(nlohmann::ordered_json& report) const;

  protected:
    // Reads messages and calls take_position() and take_force(), oldest first.
    virtual void listen(SessionTime now) = 0;
    virtual void tell_position(double position_m) = 0;
    // For the fault's text: "the ROS 2 robot at /thimble/slave/measured_cp", and of its force.
    virtual std::string place_sender() const = 0;
    virtual std::string force_sender() const = 0;

    void take_position(SessionTime now, std::uint64_t writer, double position_m) {
        position_.take(now, writer, position_m);
    }
    void take_force(SessionTime now, std::uint64_t writer, double force_N) {
        force_.take(now, writer, force_N);
    }
    bool heard_within(SessionTime now, Duration limit) const {
        return position_.heard_within(now, limit) && force_.heard_within(now, limit);
    }

  private:
    bool knows_place() const { return position_.placed() && !position_.stale(); }
    void look(SessionTime now);
    void judge(const RemoteInput& input, const std::string& sender, const char* what);
    void say_hold(SessionTime now);
    void tell(SessionTime now) {
        told_ = now;
        tell_position(*target_m_);
    }

    RobotLimits limits_;
    RemoteInput position_{};                     // m
    RemoteInput force_{{kMostForce_N, 1e9, 0}};  // N; it may jump, and guards stand behind it
    std::optional<double> target_m_;  // the last place that was sent; none: to be held where it is found
    bool following_ = false, met_ = false;  // met: the commanded place was reached since
    SessionTime told_{};                    // the last place in this trial
    SessionTime heard_{};
    SessionTime silent_at_{};  // between trials
    std::string fault_;
    std::uint64_t slowed_ = 0, outside_ = 0, clipped_ = 0;
};

}  // namespace thimble
