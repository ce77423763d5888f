// A real handle that another program reads and drives: positions come as messages and forces go as messages. This half is pure; a
// subclass brings the messages (ros2_handle.hpp).
//
// Positions come from one writer, until it has been silent for kLostAfter. A second one that sends meanwhile is a fault. A position is refused and
// counted if it is no number, out of reach, from another writer, or further from the last one than a hand gets meanwhile. Without a good
// position for kStaleAfter the handle has no force and no sample, so the needle is held; for kLostAfter, its fault ends the trial. The
// next trial takes the handle wherever it is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "common/config.hpp"
#include "master/devices/handle.hpp"

namespace thimble {

// For a driver to be started.
inline constexpr Duration kRos2DriverLimit = std::chrono::seconds{60};

// Table [handle.ros2] of a session file.
struct Ros2HandleSettings {
    std::string interface = "127.0.0.1";
};
inline Ros2HandleSettings read_ros2_handle_settings(const ConfigTable& table) {
    Ros2HandleSettings settings;
    table.read("interface", settings.interface, "Address of the one interface that DDS uses (docs/ros2.md).");
    return settings;
}

class RemoteHandle : public Handle {
  public:
    static constexpr Duration kStaleAfter = std::chrono::milliseconds{20};
    static constexpr Duration kLostAfter = std::chrono::milliseconds{300};  // before slave_sim gives up
    static constexpr double kReach_m = 1;
    // No hand is faster, for as long as a position is not stale; and an encoder's noise.
    static constexpr double kFastest_m_per_s = 5, kNoise_m = 0.001;

    explicit RemoteHandle(double force_limit_N) : force_limit_N_(force_limit_N) {}

    void start_trial(SessionTime now, const OperatorTask& /*task*/) override {
        placed_ = lost_ = false;
        fault_.clear();
        heard_ = now;
    }
    HandleSample read(SessionTime now) override {
        hear(now);
        look(now);
        return {position_m_, force_N_, placed_ && !stale_ && fault_.empty()};
    }
    void command_force(SessionTime now, double force_hand_N) override {
        const bool allowed = enabled_ && placed_ && !stale_ && fault_.empty() && std::isfinite(force_hand_N);
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
        report["remote"] = {{"positions", positions_},
                            {"not_numbers", not_numbers_},
                            {"jumps", jumps_},
                            {"other_writers", other_writers_},
                            {"stale", stales_}};
    }

  protected:
    // All that has come. A handle that was lost is taken where it then is; in a trial that is too late.
    void hear(SessionTime now) {
        if (now != heard_at_) allow(now);
        listen(now);
        if (now - heard_ <= kLostAfter) return;
        lost_ = true;
        placed_ = false;
    }
    // Brings what has come: calls take_position(), oldest first.
    virtual void listen(SessionTime now) = 0;
    // To the other program; positive pushes the hand out.
    virtual void tell_force(double force_hand_N) = 0;
    // For the fault's text: "the ROS 2 driver at /thimble/handle/measured_cp".
    virtual std::string driver() const = 0;

    void take_position(SessionTime now, std::uint64_t writer, double position_m) {
        if (came_ && writer != writer_ && now - *came_ <= kLostAfter) return refuse_other();
        writer_ = writer;
        came_ = now;
        if (!std::isfinite(position_m) || std::fabs(position_m) > kReach_m) {
            ++not_numbers_;
            return;
        }
        if (!placed_) base_m_ = position_m;
        if (std::fabs(position_m - base_m_) > allowance_m_) {
            ++jumps_;
            return;
        }
        ++positions_;
        position_m_ = position_m;
        heard_ = now;
        placed_ = true;
    }
    bool heard_within(SessionTime now, Duration limit) const { return placed_ && now - heard_ < limit; }

  private:
    static constexpr Duration kSignOfLife = std::chrono::milliseconds{10};

    // For all that comes in this instant, from the writer's last message before it: refusals must not widen it.
    void allow(SessionTime now) {
        const Duration passed = came_ ? std::min<Duration>(now - *came_, kStaleAfter) : kStaleAfter;
        allowance_m_ = kFastest_m_per_s * to_seconds(passed) + kNoise_m;
        base_m_ = position_m_;
        heard_at_ = now;
    }
    void look(SessionTime now) {
        const bool stale = now - heard_ > kStaleAfter;
        if (stale && !stale_) ++stales_;
        stale_ = stale;
        if (stale || !fault_.empty()) give(now, 0);
        if (!lost_ || !fault_.empty()) return;
        fault_ = driver() +
                 " has sent no position that can be used for 300 ms: does it run, without jumps, and with "
                 "numbers? The next trial takes the handle where it is.";
    }
    // The second program's device obeys the same forces, and the guard counts no energy of it.
    void refuse_other() {
        ++other_writers_;
        if (!fault_.empty()) return;
        fault_ = "a second program sends positions beside " + driver() +
                 ": stop one of the two, since both obey the force (ros2 topic info --verbose names them)";
    }
    void give(SessionTime now, double force_hand_N) {
        force_N_ = force_hand_N;
        given_ = now;
        tell_force(force_hand_N);
    }

    double force_limit_N_;
    bool enabled_ = false, placed_ = false, stale_ = false, lost_ = false;
    double position_m_ = 0, force_N_ = 0;
    double base_m_ = 0, allowance_m_ = 0;  // a position is within `allowance_m_` of `base_m_`
    std::uint64_t writer_ = 0;
    std::optional<SessionTime> came_;      // the writer's last message, good or not
    SessionTime heard_{}, given_{};        // the last good position; the last force
    std::optional<SessionTime> heard_at_;  // the last hear()
    std::string fault_;
    std::uint64_t positions_ = 0, not_numbers_ = 0, jumps_ = 0, other_writers_ = 0, stales_ = 0;
};

}  // namespace thimble
