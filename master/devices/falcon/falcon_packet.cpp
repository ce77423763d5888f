#include "master/devices/falcon/falcon_packet.hpp"

#include <algorithm>

namespace thimble {
namespace {

constexpr std::uint8_t kFirst = '<', kLast = '>', kLetter = 'A';
constexpr std::size_t kFlags = 13;

void put(FalconPacket& packet, const FalconTriple& values) {
    for (std::size_t i = 0; i < 12; ++i) {
        const auto bits = static_cast<std::uint16_t>(values[i / 4]);
        packet[1 + i] = static_cast<std::uint8_t>(kLetter + ((bits >> (4 * (i % 4))) & 0xf));
    }
}

// False if a letter is none of A to P.
bool get(std::span<const std::uint8_t, kFalconPacketBytes> packet, FalconTriple& values) {
    std::array<std::uint16_t, 3> bits{};
    for (std::size_t i = 0; i < 12; ++i) {
        const unsigned nibble = packet[1 + i] - unsigned{kLetter};
        if (nibble > 0xf) return false;
        bits[i / 4] = static_cast<std::uint16_t>(bits[i / 4] | (nibble << (4 * (i % 4))));
    }
    std::transform(bits.begin(), bits.end(), values.begin(),
                   [](std::uint16_t b) { return static_cast<std::int16_t>(b); });
    return true;
}

FalconPacket frame(const FalconTriple& values, unsigned flags) {
    FalconPacket packet{};
    packet.fill(kLetter);
    packet.front() = kFirst;
    packet.back() = kLast;
    put(packet, values);
    packet[kFlags] = static_cast<std::uint8_t>(kLetter + flags);
    return packet;
}

// The flags, if it is a packet.
std::optional<unsigned> unframe(std::span<const std::uint8_t, kFalconPacketBytes> packet,
                                FalconTriple& values, unsigned most) {
    const unsigned flags = packet[kFlags] - unsigned{kLetter};  // wraps below 'A' to what is too much
    if (packet.front() != kFirst || packet.back() != kLast || flags > most || !get(packet, values))
        return std::nullopt;
    return flags;
}

}  // namespace

FalconPacket encode(const FalconCommand& command) {
    FalconTriple motors{};
    std::transform(command.motors.begin(), command.motors.end(), motors.begin(), [](std::int16_t counts) {
        return std::clamp<std::int16_t>(counts, -kFalconMotorLimit, kFalconMotorLimit);
    });
    return frame(motors, (command.homing ? 1U : 0U) | (command.lights & 0xeU));
}

FalconPacket encode(const FalconReport& report) {
    return frame(report.encoders, (report.buttons & 0xfU) | ((report.homed_legs & 7U) << 4));
}

std::optional<FalconCommand> decode_falcon_command(std::span<const std::uint8_t, kFalconPacketBytes> packet) {
    FalconCommand command;
    const auto flags = unframe(packet, command.motors, 0xf);
    if (!flags) return std::nullopt;
    command.homing = (*flags & 1U) != 0;
    command.lights = static_cast<std::uint8_t>(*flags & 0xeU);
    return command;
}

std::optional<FalconReport> decode_falcon_report(std::span<const std::uint8_t, kFalconPacketBytes> packet) {
    FalconReport report;
    const auto flags = unframe(packet, report.encoders, 0x7f);
    if (!flags) return std::nullopt;
    report.buttons = static_cast<std::uint8_t>(*flags & 0xfU);
    report.homed_legs = static_cast<std::uint8_t>(*flags >> 4);
    return report;
}

std::optional<FalconReport> FalconReportReader::take(std::span<const std::uint8_t> bytes) {
    std::optional<FalconReport> newest;
    for (const std::uint8_t byte : bytes) {
        if (filled_ == kFalconPacketBytes) {
            std::rotate(window_.begin(), window_.begin() + 1, window_.end());
            --filled_;
        }
        window_[filled_++] = byte;
        if (filled_ < kFalconPacketBytes) continue;
        const auto report = decode_falcon_report(window_);
        if (!report) continue;
        newest = report;
        ++reports_;
        filled_ = 0;
    }
    return newest;
}

}  // namespace thimble
