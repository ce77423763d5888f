#include "master/handle_control.hpp"

#include <algorithm>

namespace thimble {

HandleControl::HandleControl(const ControlSettings& settings, const HandleControlScale& scale)
    : scale_(scale) {
    if (settings.compensator != Compensator::kNone) end_.emplace(settings, scale);
}

void HandleControl::start(bool kinesthetic, Duration network_delay) {
    present_ = kinesthetic && end_;
    burst_ = {};
    if (present_) end_->start(network_delay);
}

void HandleControl::network_changed(Duration network_delay) {
    if (present_) end_->network_changed(network_delay);
}

void HandleControl::sample(SessionTime now, const HandleSample& handle, double velocity_hand_m_per_s) {
    burst_ = end_->sample(now, handle.position_hand_m, velocity_hand_m_per_s, handle.force_hand_N);
}

void HandleControl::take(const WaveBurst& waves) { end_->receive(waves); }

void HandleControl::take(const ForceFeedback& feedback, Duration age) {
    if (feedback.needle_held) return forget();
    end_->receive(feedback_of(feedback, scale_, to_seconds(age)));
}

void HandleControl::predict(const ForceFeedback& feedback, Duration age) {
    end_->predict(feedback_of(feedback, scale_, to_seconds(age)));
}

void HandleControl::forget() { end_->forget(); }

double HandleControl::force_N() {
    return std::clamp(end_->force_N(), -scale_.force_limit_N, scale_.force_limit_N);
}

}  // namespace thimble
