// Table [codec] of a session file: which samples of the two haptic flows are not sent. docs/codecs.md.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>

#include "common/config.hpp"
#include "common/time.hpp"

namespace thimble {

enum class HapticCodec : std::uint8_t {
    kNone,            // every sample is sent
    kDeadband,        // what differs by more than a Weber fraction; the receiver holds the last one
    kDeadbandLinear,  // the same, against a straight line through what was sent
    kEveryNth,        // baseline: by number
    kSendOnDelta,     // baseline: by absolute difference
};
inline constexpr std::array<std::string_view, 5> kHapticCodecNames{"none", "deadband", "deadband-linear",
                                                                   "every-nth", "send-on-delta"};
constexpr bool is_deadband(HapticCodec codec) {
    return codec == HapticCodec::kDeadband || codec == HapticCodec::kDeadbandLinear;
}

struct CodecSettings {
    HapticCodec command = HapticCodec::kNone, force = HapticCodec::kNone;
    double weber_fraction = 0.1;
    double velocity_floor_m_per_s = 0.04;  // of the needle: the deadband is never narrower than k times this
    double force_floor_N = 0.5;
    double delta_position_m = 1e-4;  // of the needle; also what a deadband lets its place be wrong by
    double delta_force_N = 0.05;
    unsigned every = 10;
    Duration refresh = std::chrono::milliseconds{30};

    bool used() const { return command != HapticCodec::kNone || force != HapticCodec::kNone; }
    // The slave's stale_after_s where the file has none: two refreshes may be lost.
    Duration slave_patience() const { return refresh * 10 / 3; }
};

// Throws Error (usage).
CodecSettings read_codec_settings(const ConfigTable& table);
// Refuses a refresh bound that would let an output's stale policy trip after two lost packets. `after`: of [`node`] stale_after_s.
void check_refresh(const ConfigTable& table, const CodecSettings& codec, std::string_view node,
                   Duration after);

}  // namespace thimble
