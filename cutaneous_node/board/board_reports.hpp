// Reports between this computer and a fingertip board of your own making, as bytes and as values.
// docs/board-protocol.md describes them for the board's side. Both directions are here, so that tests can emulate a
// board.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace thimble {

// A board's identity in its report descriptor.
inline constexpr std::uint16_t kBoardUsagePage = 0xff54, kBoardUsage = 0x01;
inline constexpr std::size_t kBoardReportBytes = 10;
inline constexpr std::uint8_t kBoardVersion = 1;

using BoardReport = std::array<std::uint8_t, kBoardReportBytes>;

// Computer to board, report 1.
struct BoardCommand {
    std::uint8_t sequence = 0;
    bool press = false;  // false: slack, whatever the forces
    std::uint16_t index_mN = 0, thumb_mN = 0;
    bool operator==(const BoardCommand&) const = default;
};

enum class BoardFault : std::uint8_t {
    kNone,
    kOverCurrent,
    kOverTemperature,
    kSensor,
    kSupply,
    kCalibration,
    kOther,  // 255 on the wire
};

// Board to computer, report 2.
struct BoardStatus {
    std::uint8_t sequence = 0;  // of the newest good command
    bool pressing = false;
    bool watchdog = false;  // slack, because no command came in time
    BoardFault fault = BoardFault::kNone;
    std::uint16_t index_mN = 0, thumb_mN = 0;  // as measured, else as commanded
};

BoardReport encode(const BoardCommand& command);
BoardReport encode(const BoardStatus& status);
// None: another report, or one that is too short, garbled, or of another version.
std::optional<BoardCommand> decode_board_command(std::span<const std::uint8_t> report);
std::optional<BoardStatus> decode_board_status(std::span<const std::uint8_t> report);
// A whole status or command of a version that is not ours.
bool is_of_another_version(std::span<const std::uint8_t> report);

// CRC-8, polynomial 0x07, started with 0 (SMBus).
std::uint8_t crc8(std::span<const std::uint8_t> bytes);

}  // namespace thimble
