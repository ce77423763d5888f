#include "common/reduction/codec_settings.hpp"

#include <utility>

namespace thimble {
namespace {

// A key that no chosen codec uses would be without effect.
void refuse_unused(const ConfigTable& table, const CodecSettings& s) {
    const auto either = [&](HapticCodec codec) { return s.command == codec || s.force == codec; };
    const bool deadband = is_deadband(s.command) || is_deadband(s.force);
    const bool delta = either(HapticCodec::kSendOnDelta);
    const std::array uses{
        std::pair{std::string_view{"weber_fraction"}, deadband},
        std::pair{std::string_view{"velocity_floor_m_per_s"}, is_deadband(s.command)},
        std::pair{std::string_view{"force_floor_N"}, is_deadband(s.force)},
        std::pair{std::string_view{"delta_position_m"},
                  is_deadband(s.command) || s.command == HapticCodec::kSendOnDelta},
        std::pair{std::string_view{"delta_force_N"}, delta && s.force == HapticCodec::kSendOnDelta},
        std::pair{std::string_view{"every"}, either(HapticCodec::kEveryNth)},
        std::pair{std::string_view{"refresh_s"}, s.used()},
    };
    for (const auto& [key, used] : uses) {
        if (!used && table.has(key))
            table.fail(key, "has no effect: command is \"{}\" and force is \"{}\"",
                       kHapticCodecNames[static_cast<std::size_t>(s.command)],
                       kHapticCodecNames[static_cast<std::size_t>(s.force)]);
    }
}

}  // namespace

CodecSettings read_codec_settings(const ConfigTable& table) {
    CodecSettings s;
    table.read("command", s.command, kHapticCodecNames,
               "Codec of the master: which needle commands it sends.");
    table.read("force", s.force, kHapticCodecNames,
               "Codec of slave_sim: which forces it sends to handle, finger and bar.");
    table.read("weber_fraction", s.weber_fraction, 0.001, 1,
               "deadband: largest change of velocity or force that is not sent, as a fraction of the last "
               "value sent.");
    table.read("velocity_floor_m_per_s", s.velocity_floor_m_per_s, 0, 10,
               "deadband, command: for slower needles the deadband of this velocity is used.");
    table.read("force_floor_N", s.force_floor_N, 0, 10,
               "deadband, force: for smaller forces the deadband of this force is used.");
    table.read("delta_position_m", s.delta_position_m, 1e-7, 0.1,
               "send-on-delta and deadband, command: largest error of the needle's position at the slave.");
    table.read("delta_force_N", s.delta_force_N, 1e-6, 100,
               "send-on-delta, force: smallest change that is sent.");
    table.read("every", s.every, 2, 1000, "every-nth: n; one of n samples is sent.");
    table.read("refresh_s", s.refresh, 0.002, 1,
               "Longest time without a packet; a new packet also replaces a lost one.");
    refuse_unused(table, s);
    return s;
}

void check_refresh(const ConfigTable& table, const CodecSettings& codec, std::string_view node,
                   Duration after) {
    if (!codec.used() || 3 * codec.refresh < after) return;
    table.fail("refresh_s",
               "is {} s, but {}.stale_after_s is {} s: two lost packets would let the output fall; use less "
               "than a third of it",
               to_seconds(codec.refresh), node, to_seconds(after));
}

}  // namespace thimble
