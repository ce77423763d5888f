// Forces that are not sent, and what stands for them at the handle. F of the last packet, t since, F' the slope between the last two:
//
//     F^(t) = F            hold: deadband, every-nth, send-on-delta; finger and bar always
//
//     F^(t) = F + F' t     deadband-linear; never with the other sign, and never farther from F than
//                          max(k max(|F|, F_floor), |dF|), where dF is the difference of the last two
//
// F' is 0 where the two are less than half a period apart: there the clocks' jitter would be the slope.
//
// An answer is sent after `refresh` at the latest, and if phase, fixture or hold have changed. A deadband sends it if
//
//     |F(t) - F^(t)| > k max(|F|, F_floor)      Hinterseer and Steinbach 2006, Hinterseer et al. 2008
//
// and send-on-delta if
//
//     |F(t) - F| > delta
//
// After a lost packet the two ends have different slopes until two more have come. The bound limits the force that is made up.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/messages.hpp"
#include "common/reduction/codec_settings.hpp"

namespace thimble {

// Half the width of the deadband about the force sent last.
inline double deadband_N(const CodecSettings& settings, const ForceFeedback& sent) {
    return settings.weber_fraction * std::max(std::abs(sent.force_total_N), settings.force_floor_N);
}

// The straight line through the last two forces of a flow, by the stamps of the samples that they answer.
class ForceLine {
  public:
    // period: of the master's samples. Both ends must have the same.
    ForceLine(const CodecSettings& settings, Duration period) : settings_(settings), period_(period) {}

    void reset() { points_ = 0; }
    void add(const ForceFeedback& feedback) {
        const Duration elapsed = feedback.echo_time - newest_.echo_time;
        const double change_N = feedback.force_total_N - newest_.force_total_N;
        const bool slopes = points_ > 0 && elapsed >= period_ / 2;
        slope_N_per_s_ = slopes ? change_N / to_seconds(elapsed) : 0;
        newest_ = feedback;
        most_N_ = std::max(deadband_N(settings_, newest_), std::abs(change_N));
        ++points_;
    }
    bool empty() const { return points_ == 0; }
    const ForceFeedback& newest() const { return newest_; }
    double at(Duration since) const {
        const double change_N = std::clamp(slope_N_per_s_ * to_seconds(since), -most_N_, most_N_);
        const double force_N = newest_.force_total_N + change_N;
        return newest_.force_total_N < 0 ? std::min(force_N, 0.0) : std::max(force_N, 0.0);
    }

  private:
    CodecSettings settings_;
    Duration period_;
    ForceFeedback newest_;
    double slope_N_per_s_ = 0, most_N_ = 0;
    unsigned points_ = 0;
};

// slave_sim's end of one flow.
class ForceGate {
  public:
    // predicts: the receiver draws the line. period: of the master's samples.
    ForceGate(const CodecSettings& settings, Duration period, bool predicts)
        : settings_(settings), predicts_(predicts), period_(period), line_(settings, period) {}

    void reset() { line_.reset(); }
    // Whether this answer is sent. Once per answer, in order.
    bool due(SessionTime now, const ForceFeedback& feedback) {
        if (settings_.force == HapticCodec::kNone) return true;
        if (!line_.empty() && !changed(now, feedback)) return false;
        sent_at_ = now;
        line_.add(feedback);
        return true;
    }

  private:
    bool changed(SessionTime now, const ForceFeedback& feedback) const {
        if (now - sent_at_ >= settings_.refresh) return true;
        const ForceFeedback& sent = line_.newest();
        if (feedback.phase != sent.phase || feedback.fixture_present != sent.fixture_present ||
            feedback.needle_held != sent.needle_held)
            return true;
        if (settings_.force == HapticCodec::kEveryNth)  // stamps jitter
            return feedback.echo_time - sent.echo_time >= settings_.every * period_ - period_ / 2;
        return !(std::abs(feedback.force_total_N - there_N(feedback)) <= width_N());
    }
    double there_N(const ForceFeedback& feedback) const {
        if (!predicts_ || settings_.force != HapticCodec::kDeadbandLinear)
            return line_.newest().force_total_N;
        return line_.at(feedback.echo_time - line_.newest().echo_time);
    }
    double width_N() const {
        return is_deadband(settings_.force) ? deadband_N(settings_, line_.newest()) : settings_.delta_force_N;
    }

    CodecSettings settings_;
    bool predicts_;
    Duration period_;
    SessionTime sent_at_{};
    ForceLine line_;
};

// The handle's end: the force between two packets, where it is not simply held.
class ForceFill {
  public:
    ForceFill(const CodecSettings& settings, Duration period)
        : settings_(settings), line_(settings, period) {}

    void reset() { line_.reset(); }
    void heard(SessionTime now, const ForceFeedback& feedback) {
        if (settings_.force != HapticCodec::kDeadbandLinear) return;
        heard_at_ = now;
        line_.add(feedback);
    }
    bool predicts() const { return !line_.empty(); }
    ForceFeedback at(SessionTime now) const {
        ForceFeedback feedback = line_.newest();
        feedback.force_total_N = line_.at(std::min(now - heard_at_, settings_.refresh));
        return feedback;
    }

  private:
    CodecSettings settings_;
    SessionTime heard_at_{};
    ForceLine line_;
};

}  // namespace thimble
