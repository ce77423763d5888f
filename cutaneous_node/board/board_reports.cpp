#include "cutaneous_node/board/board_reports.hpp"

namespace thimble {
namespace {

constexpr std::uint8_t kCommandReport = 1, kStatusReport = 2;
constexpr std::uint8_t kPress = 1, kWatchdog = 2;  // flags
constexpr std::uint8_t kOtherFault = 255;
constexpr std::size_t kNumber = 0, kVersionAt = 1, kSequence = 2, kFlags = 3, kIndex = 4, kThumb = 6,
                      kFaultAt = 8, kCrc = 9;

void put(BoardReport& report, std::size_t at, std::uint16_t value) {
    report[at] = static_cast<std::uint8_t>(value & 0xffU);
    report[at + 1] = static_cast<std::uint8_t>(value >> 8U);
}

std::uint16_t get(std::span<const std::uint8_t> report, std::size_t at) {
    return static_cast<std::uint16_t>(report[at] + 256U * report[at + 1]);
}

BoardReport sealed(BoardReport report) {
    report[kVersionAt] = kBoardVersion;
    report[kCrc] = crc8(std::span(report).first(kCrc));
    return report;
}

bool is_whole(std::span<const std::uint8_t> report) {
    return report.size() == kBoardReportBytes && crc8(report.first(kCrc)) == report[kCrc];
}

bool is_good(std::span<const std::uint8_t> report, std::uint8_t number) {
    return is_whole(report) && report[kNumber] == number && report[kVersionAt] == kBoardVersion;
}

BoardFault fault_of(std::uint8_t code) {
    return code < static_cast<std::uint8_t>(BoardFault::kOther) ? static_cast<BoardFault>(code)
                                                                : BoardFault::kOther;
}

}  // namespace

BoardReport encode(const BoardCommand& command) {
    BoardReport report{kCommandReport};
    report[kSequence] = command.sequence;
    report[kFlags] = command.press ? kPress : 0;
    put(report, kIndex, command.index_mN);
    put(report, kThumb, command.thumb_mN);
    return sealed(report);
}

BoardReport encode(const BoardStatus& status) {
    BoardReport report{kStatusReport};
    report[kSequence] = status.sequence;
    report[kFlags] =
        static_cast<std::uint8_t>((status.pressing ? kPress : 0) | (status.watchdog ? kWatchdog : 0));
    put(report, kIndex, status.index_mN);
    put(report, kThumb, status.thumb_mN);
    report[kFaultAt] =
        status.fault == BoardFault::kOther ? kOtherFault : static_cast<std::uint8_t>(status.fault);
    return sealed(report);
}

std::optional<BoardCommand> decode_board_command(std::span<const std::uint8_t> report) {
    if (!is_good(report, kCommandReport)) return std::nullopt;
    return BoardCommand{report[kSequence], (report[kFlags] & kPress) != 0, get(report, kIndex),
                        get(report, kThumb)};
}

std::optional<BoardStatus> decode_board_status(std::span<const std::uint8_t> report) {
    if (!is_good(report, kStatusReport)) return std::nullopt;
    return BoardStatus{report[kSequence],
                       (report[kFlags] & kPress) != 0,
                       (report[kFlags] & kWatchdog) != 0,
                       fault_of(report[kFaultAt]),
                       get(report, kIndex),
                       get(report, kThumb)};
}

bool is_of_another_version(std::span<const std::uint8_t> report) {
    return is_whole(report) && report[kVersionAt] != kBoardVersion;
}

std::uint8_t crc8(std::span<const std::uint8_t> bytes) {
    unsigned crc = 0;
    for (const std::uint8_t byte : bytes) {
        crc ^= byte;
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x80U) != 0 ? (crc << 1U) ^ 0x07U : crc << 1U;
        crc &= 0xffU;
    }
    return static_cast<std::uint8_t>(crc);
}

}  // namespace thimble
