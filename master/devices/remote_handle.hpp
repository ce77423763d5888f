// A real handle that another program or thread reads and drives: positions come as messages and forces go as messages. This half is
// pure; a subclass brings the messages (ros2_handle.hpp, mailbox_handle.hpp).
//
// RemoteInput has the rules of its positions. A second program that sends them is a fault. While positions are stale
// the handle has no force and no sample, so the needle is held; when they are lost, its fault ends the trial.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "common/remote_input.hpp"
#include "master/devices/handle.hpp"

namespace thimble {

class RemoteHandle : public Handle {
  public:
    static constexpr Duration kStaleAfter = RemoteInput::kStaleAfter, kLostAfter = RemoteInput::kLostAfter;

    explicit RemoteHandle(double force_limit_N) : force_limit_N_(force_limit_N) {}

    void start_trial(SessionTime now, const OperatorTask& /*task*/) override {
        positions_.start_trial(now);
        fault_.clear();
    }
    HandleSample read(SessionTime now) override {
        hear(now);
        look(now);
        withheld_ = false;  // this sample has no force
        return {positions_.value(), force_N_, is_felt()};
    }
    void command_force(SessionTime now, double force_hand_N) override {
        const bool allowed = may_push() && !withheld_ && std::isfinite(force_hand_N);
        give(now, allowed ? std::clamp(force_hand_N, -force_limit_N_, force_limit_N_) : 0);
    }
    void enable_force(SessionTime now, bool enabled) override {
        enabled_ = enabled;
        if (!enabled) give(now, 0);
    }
    // Between trials the master reads no sample, but the driver on the other side still needs forces.
    bool take_stop(SessionTime now) override {
        hear(now);
        if (now - given_ >= kSignOfLife) give(now, enabled_ ? force_N_ : 0);
        return false;
    }
    SessionTime next_look() const override { return given_ + kSignOfLife; }
    std::string_view fault() const override { return fault_; }

    void describe(nlohmann::ordered_json& report) const override {
        report["remote"] = positions_.describe("positions");
    }

  protected:
    void hear(SessionTime now) {
        positions_.open(now);
        listen(now);
        positions_.close(now);
        if (positions_.second_writer()) refuse_other();
    }
    // Reads messages and calls take_position(), oldest first.
    virtual void listen(SessionTime now) = 0;
    // Sends a force to the other program, N; positive pushes the hand out.
    virtual void tell_force(double force_hand_N) = 0;
    // For the fault's text: "the ROS 2 driver at /thimble/handle/measured_cp".
    virtual std::string driver() const = 0;
    // For the fault's text: how force comes back once the driver runs again.
    virtual std::string remedy() const { return "The next trial continues from its position then."; }

    void take_position(SessionTime now, std::uint64_t writer, double position_m) {
        positions_.take(now, writer, position_m);
    }
    bool heard_within(SessionTime now, Duration limit) const { return positions_.heard_within(now, limit); }
    bool may_push() const { return enabled_ && is_felt(); }
    // The other side gives no force. read() reports that before a command has an effect again.
    void withhold() {
        force_N_ = 0;
        withheld_ = true;
    }
    // The first fault of a trial stays.
    void fail(const std::string& what) {
        if (fault_.empty()) fault_ = what;
    }

  private:
    static constexpr Duration kSignOfLife = std::chrono::milliseconds{10};

    bool is_felt() const { return positions_.placed() && !positions_.stale() && fault_.empty(); }
    void look(SessionTime now) {
        const bool stale = positions_.look(now);
        if (stale || !fault_.empty()) give(now, 0);
        if (!positions_.lost()) return;
        fail(driver() +
             " has sent no usable position for 300 ms: does it run, and are its positions numbers without "
             "jumps? " +
             remedy());
    }
    // A second program is refused: its device would get the same forces, whose energy the guard does not measure.
    void refuse_other() {
        fail("a second program sends positions beside " + driver() +
             ": stop one of the two, because the device follows both (ros2 topic info --verbose names them)");
    }
    void give(SessionTime now, double force_hand_N) {
        force_N_ = force_hand_N;
        given_ = now;
        tell_force(force_hand_N);
    }

    double force_limit_N_;
    bool enabled_ = false, withheld_ = false;
    RemoteInput positions_;  // of the hand, m
    double force_N_ = 0;
    SessionTime given_{};  // the last force
    std::string fault_;
};

}  // namespace thimble
