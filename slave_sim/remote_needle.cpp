#include "slave_sim/remote_needle.hpp"

namespace thimble {

void RemoteNeedle::hear(SessionTime now) {
    position_.open(now);
    force_.open(now);
    listen(now);
    position_.close(now);
    force_.close(now);
    heard_ = now;
    if (now >= silent_at_) return;
    look(now);
    if (!following_ && now - told_ >= kSignOfLife && knows_place()) say_hold(now);
}

void RemoteNeedle::look(SessionTime now) {
    position_.look(now);
    force_.look(now);
    judge(position_, place_sender(), "position");
    judge(force_, force_sender(), "force");
    if (following_ && !is_felt()) hold(now);
}

void RemoteNeedle::judge(const RemoteInput& input, const std::string& sender, const char* what) {
    if (!fault_.empty() || silent_at_ != kNever) return;
    if (input.second_writer()) {
        fault_ = fmt::format(
            "a second program sends beside {}: stop one of the two (ros2 topic info --verbose names them)",
            sender);
    } else if (input.lost()) {
        fault_ = fmt::format(
            "{} has sent no usable {} for 300 ms: does it run, and are its values numbers without jumps? The "
            "next trial continues from the needle's position then.",
            sender, what);
    }
}

void RemoteNeedle::command(SessionTime now, double position_m) {
    if (!is_felt()) return;
    if (!following_) {
        following_ = true;
        met_ = false;
        target_m_ = position_.value();
        told_ = now;
    }
    const double goal_m = std::clamp(position_m, limits_.shallowest_m, limits_.deepest_m);
    if (goal_m != position_m) ++outside_;
    const double fastest_m_per_s =
        met_ ? limits_.speed_limit_m_per_s : std::min(kRamp_m_per_s, limits_.speed_limit_m_per_s);
    const double step_m =
        fastest_m_per_s * to_seconds(std::min<Duration>(now - told_, RemoteInput::kStaleAfter));
    const double way_m = goal_m - *target_m_;
    if (std::fabs(way_m) <= step_m) {
        target_m_ = goal_m;
        met_ = true;
    } else {
        *target_m_ += std::copysign(step_m, way_m);
        if (met_) ++slowed_;
    }
    if (std::fabs(force_.value()) > limits_.force_limit_N) ++clipped_;
    tell(now);
}

void RemoteNeedle::hold(SessionTime now) {
    if (!following_) return;
    following_ = false;
    target_m_.reset();
    if (knows_place()) say_hold(now);
}

// Holds at the first measured place. Following the measurement would cause a slow drift.
void RemoteNeedle::say_hold(SessionTime now) {
    if (!target_m_) target_m_ = position_.value();
    tell(now);
}

bool RemoteNeedle::repeat_hold(SessionTime now) {
    if (following_ || !target_m_ || now >= silent_at_) return false;
    tell(now);
    return true;
}

void RemoteNeedle::describe(nlohmann::ordered_json& report) const {
    report["robot"] = {{"position", position_.describe("taken")},
                       {"force", force_.describe("taken")},
                       {"slowed", slowed_},
                       {"outside", outside_},
                       {"clipped", clipped_}};
}

}  // namespace thimble
