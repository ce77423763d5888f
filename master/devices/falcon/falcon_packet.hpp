// The packets between the Novint Falcon and its host: 16 bytes each way, one report for each command (docs/handles.md names the
// source). Pure: bytes in, values out.
//
// '<', three signed 16-bit numbers of four letters each ('A' + nibble, lowest first), a letter of flags, 'A', '>'. The flags are
// 'A' + bits and may pass 0x7f.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace thimble {

inline constexpr std::size_t kFalconPacketBytes = 16;
inline constexpr std::int16_t kFalconMotorLimit = 4095;

using FalconPacket = std::array<std::uint8_t, kFalconPacketBytes>;
using FalconTriple = std::array<std::int16_t, 3>;  // of the legs: top, right, left, seen from the front

enum FalconButton : std::uint8_t {
    kFalconPlus = 1,
    kFalconForward = 2,
    kFalconCentre = 4,
    kFalconMinus = 8,
    kFalconAnyButton = 15
};
enum FalconLight : std::uint8_t { kFalconGreen = 2, kFalconBlue = 4, kFalconRed = 8 };

struct FalconCommand {
    FalconTriple motors{};  // counts; beyond +-kFalconMotorLimit they are cut
    bool homing = true;     // in each packet, or the legs never count as homed
    std::uint8_t lights = 0;
};

struct FalconReport {
    FalconTriple encoders{};      // counts from where the leg was homed
    std::uint8_t buttons = 0;     // FalconButton, together
    std::uint8_t homed_legs = 0;  // a bit each
    bool homed() const { return homed_legs == 7; }
};

FalconPacket encode(const FalconCommand& command);
FalconPacket encode(const FalconReport& report);
// Nothing if it is no packet.
std::optional<FalconCommand> decode_falcon_command(std::span<const std::uint8_t, kFalconPacketBytes> packet);
std::optional<FalconReport> decode_falcon_report(std::span<const std::uint8_t, kFalconPacketBytes> packet);

// Finds the reports in a stream of bytes that may begin anywhere and lose some.
class FalconReportReader {
  public:
    // The newest report that these bytes complete.
    std::optional<FalconReport> take(std::span<const std::uint8_t> bytes);
    std::uint64_t reports() const { return reports_; }

  private:
    FalconPacket window_{};
    std::size_t filled_ = 0;
    std::uint64_t reports_ = 0;
};

}  // namespace thimble
