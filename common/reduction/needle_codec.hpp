// Needle commands that are not sent, and what stands for them at the slave. Both ends compute the same place from the last packet
// alone, so that a lost packet is forgotten with the next one. t since that packet, x and v of it:
//
//     x^(t) = x            hold: deadband, every-nth, send-on-delta
//
//     x^(t) = x + v t      deadband-linear
//
// A sample is sent after `refresh` at the latest. A deadband sends it if
//
//     |v(t) - v| > k max(|v|, v_floor)      Hinterseer and Steinbach 2006, Hinterseer et al. 2008
//
// and, as send-on-delta, if the place is wrong, because a velocity within its deadband still drifts away:
//
//     |x(t) - x^(t)| > delta
//
// Hold policy: a needle that a force pushes out is not moved inwards without a command. So between two packets the slave's end does
// no work against the force that the hand feels (the aim of Hirche et al. 2007, by other means).
#pragma once

#include <algorithm>
#include <cmath>

#include "common/messages.hpp"
#include "common/reduction/codec_settings.hpp"

namespace thimble {

// Whether the needle stands still after `sent`.
inline bool stands(const NeedleCommand& sent, HapticCodec codec) {
    const bool pushed_out = sent.force_hand_N > 0 && sent.velocity_needle_m_per_s > 0;
    return codec != HapticCodec::kDeadbandLinear || pushed_out;
}

// The command so long after `sent`.
inline NeedleCommand reconstructed(const NeedleCommand& sent, Duration since, HapticCodec codec) {
    NeedleCommand now = sent;
    if (stands(sent, codec)) return now;
    const double elapsed_s = to_seconds(since);
    const double way_m = sent.velocity_needle_m_per_s * elapsed_s;
    now.position_needle_m += way_m;
    now.position_needle_estimate_m += way_m;
    now.position_hand_m += sent.velocity_hand_m_per_s * elapsed_s;
    return now;
}

// The master's end.
class NeedleGate {
  public:
    explicit NeedleGate(const CodecSettings& settings) : settings_(settings) {}

    void reset() { known_ = false; }
    // Whether this sample is sent. Once per sample, in order.
    bool due(SessionTime now, const NeedleCommand& command) {
        if (settings_.command == HapticCodec::kNone) return true;
        ++skipped_;
        if (known_ && !changed(now, command)) return false;
        known_ = true;
        skipped_ = 0;
        sent_at_ = now;
        sent_ = command;
        return true;
    }

  private:
    bool changed(SessionTime now, const NeedleCommand& command) const {
        if (now - sent_at_ >= settings_.refresh) return true;
        if (settings_.command == HapticCodec::kEveryNth) return skipped_ >= settings_.every;
        return astray(now, command) || (is_deadband(settings_.command) && felt(command));
    }
    bool astray(SessionTime now, const NeedleCommand& command) const {
        const NeedleCommand there = reconstructed(sent_, now - sent_at_, settings_.command);
        const double reading_m = command.position_needle_m - there.position_needle_m;
        const double estimate_m = command.position_needle_estimate_m - there.position_needle_estimate_m;
        // False for a value that is not a number, so that it is sent, and refused where it arrives.
        return !(std::abs(reading_m) <= settings_.delta_position_m &&
                 std::abs(estimate_m) <= settings_.delta_position_m);
    }
    bool felt(const NeedleCommand& command) const {
        const double sent = sent_.velocity_needle_m_per_s;
        const double width =
            settings_.weber_fraction * std::max(std::abs(sent), settings_.velocity_floor_m_per_s);
        return !(std::abs(command.velocity_needle_m_per_s - sent) <= width);
    }

    CodecSettings settings_;
    bool known_ = false;
    unsigned skipped_ = 0;
    SessionTime sent_at_{};
    NeedleCommand sent_;
};

// The slave's end: a sample for each of the master's periods, with the stamps that the master would have given. A sample without a
// packet is made half a period after its packet would have come: a packet that is a little late is not overtaken. Stamps
// may jitter: a packet less than half a period beyond the newest sample counts from the next sample on. Samples never run ahead of
// the newest packet by more than the refresh bound, whatever the network does.
class NeedleFill {
  public:
    struct Sample {
        SessionTime stamp{};
        std::uint32_t sequence = 0;  // of the newest packet
        NeedleWave message;
        bool moves = false;  // else the scene waits, and the next packet moves it along a straight line
    };

    NeedleFill(const CodecSettings& settings, Duration period) : settings_(settings), period_(period) {}

    void reset() {
        known_ = false;
        next_ = kNever;
    }
    // The needle is held: no further sample until the next packet.
    void pause() { next_ = kNever; }
    bool used() const { return settings_.command != HapticCodec::kNone; }
    // A packet came. True: it is half a period newer than the newest sample, and is answered now. Else it counts from the next
    // sample on.
    bool heard(SessionTime now, const Header& header, const NeedleWave& message) {
        if (!used()) return true;
        newest_ = header.send_time;
        sample_.sequence = header.sequence;
        sent_ = message;
        // Another master has another clock.
        const bool ahead = !known_ || header.instance != instance_ || newest_ > sample_.stamp + period_ / 2;
        instance_ = header.instance;
        if (ahead) sample_.stamp = newest_;
        fresh_ = !ahead;
        if (ahead) next_ = now + period_ + period_ / 2;
        if (next_ == kNever) next_ = now + period_ / 2;
        known_ = true;
        return ahead;
    }

    SessionTime next() const { return next_; }
    // The sample that is due, null if none is. Those that were missed are skipped.
    const Sample* take(SessionTime now) {
        if (now < next_) return nullptr;
        const auto periods = 1 + (now - next_) / period_;
        const SessionTime stamp = sample_.stamp + periods * period_;
        if (stamp - newest_ > settings_.refresh) {
            next_ = kNever;
            return nullptr;
        }
        next_ += periods * period_;
        sample_.stamp = stamp;
        sample_.message.command = reconstructed(sent_.command, stamp - newest_, settings_.command);
        sample_.message.waves = sent_.waves;
        sample_.moves = fresh_ || !stands(sent_.command, settings_.command);
        fresh_ = false;
        return &sample_;
    }

  private:
    CodecSettings settings_;
    Duration period_;
    bool known_ = false;
    bool fresh_ = false;  // the newest packet has not moved the needle yet
    std::uint64_t instance_ = 0;
    SessionTime newest_{}, next_ = kNever;
    NeedleWave sent_;
    Sample sample_;
};

}  // namespace thimble
