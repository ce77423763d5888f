#include "netem/relay/packet_record.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

constexpr std::string_view kMagic = "THIMBLEN";
constexpr std::uint32_t kFormatVersion = 1;
constexpr std::uint32_t kCorrupted = 1, kCopy = 2;  // flags

template <typename Integer>
void put(std::span<std::uint8_t> bytes, std::size_t at, Integer value) {
    const auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof value; ++i) bytes[at + i] = static_cast<std::uint8_t>(bits >> (8 * i));
}

template <typename Integer>
Integer get(std::span<const std::uint8_t> bytes, std::size_t at) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i) bits |= std::uint64_t{bytes[at + i]} << (8 * i);
    return static_cast<Integer>(bits);
}

// Of a moment that may be missing.
std::string moment(std::int64_t ns) { return ns == 0 ? "" : fmt::format("{}", ns); }

}  // namespace

std::string_view to_string(RelayDirection direction) {
    return direction == RelayDirection::kUp ? "up" : "down";
}

std::string_view to_string(LoggedFate fate) {
    constexpr std::array<std::string_view, kLoggedFates> kNames{
        "sent", "lost", "outage", "oversized", "queue_full", "overflowed", "refused", "gap"};
    return kNames[static_cast<std::size_t>(fate)];
}

PacketRecord record_of(const Departure& departure, SessionTime sent, bool accepted) {
    return {.packet = departure.packet,
            .received_ns = to_nanoseconds(departure.received),
            .due_ns = to_nanoseconds(departure.due),
            .sent_ns = accepted ? to_nanoseconds(sent) : 0,
            .bytes = static_cast<std::uint32_t>(departure.bytes.size()),
            .fate = accepted ? LoggedFate::kSent : LoggedFate::kRefused,
            .corrupted = departure.corrupted,
            .copy = departure.copy};
}

void DropLog::on_drop(std::uint64_t packet, SessionTime received, std::size_t bytes, DropReason reason) {
    PacketRecord record = fixed_;
    record.packet = packet;
    record.received_ns = to_nanoseconds(received);
    record.bytes = static_cast<std::uint32_t>(bytes);
    record.fate = fate_of(reason);
    log_->add(record);
}

std::array<std::uint8_t, kLogHeaderBytes> log_header() {
    std::array<std::uint8_t, kLogHeaderBytes> bytes{};
    std::copy(kMagic.begin(), kMagic.end(), bytes.begin());
    put(bytes, 8, kFormatVersion);
    put(bytes, 12, static_cast<std::uint32_t>(kRecordBytes));
    return bytes;
}

void check_log_header(std::span<const std::uint8_t> bytes, const std::string& name) {
    const auto expected = log_header();
    if (bytes.size() < kLogHeaderBytes || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
        throw Error(ExitCode::kData,
                    "'{}' is not a packet log of thimble-netem: it does not begin with {}; --log writes one",
                    name, kMagic);
    }
    if (!std::equal(expected.begin(), expected.end(), bytes.begin())) {
        throw Error(ExitCode::kData,
                    "'{}' is a packet log of version {} with records of {} bytes; this program reads version "
                    "{} with {}",
                    name, get<std::uint32_t>(bytes, 8), get<std::uint32_t>(bytes, 12), kFormatVersion,
                    kRecordBytes);
    }
}

std::array<std::uint8_t, kRecordBytes> encode(const PacketRecord& record) {
    std::array<std::uint8_t, kRecordBytes> bytes{};
    put(bytes, 0, record.packet);
    put(bytes, 8, record.received_ns);
    put(bytes, 16, record.due_ns);
    put(bytes, 24, record.sent_ns);
    put(bytes, 32, record.flow);
    put(bytes, 36, record.bytes);
    put(bytes, 40, record.inlet);
    put(bytes, 42, static_cast<std::uint8_t>(record.direction));
    put(bytes, 43, static_cast<std::uint8_t>(record.fate));
    put(bytes, 44,
        static_cast<std::uint8_t>((record.corrupted ? kCorrupted : 0U) | (record.copy ? kCopy : 0U)));
    return bytes;
}

std::optional<PacketRecord> decode_record(std::span<const std::uint8_t, kRecordBytes> bytes) {
    const std::uint8_t direction = bytes[42], fate = bytes[43];
    const auto flags = get<std::uint32_t>(bytes, 44);
    if (direction > 1 || fate >= kLoggedFates || flags > (kCorrupted | kCopy)) return std::nullopt;
    return PacketRecord{get<std::uint64_t>(bytes, 0),  get<std::int64_t>(bytes, 8),
                        get<std::int64_t>(bytes, 16),  get<std::int64_t>(bytes, 24),
                        get<std::uint32_t>(bytes, 32), get<std::uint32_t>(bytes, 36),
                        get<std::uint16_t>(bytes, 40), static_cast<RelayDirection>(direction),
                        static_cast<LoggedFate>(fate), (flags & kCorrupted) != 0,
                        (flags & kCopy) != 0};
}

std::string_view record_csv_header() {
    return "inlet,flow,direction,packet,bytes,fate,corrupted,copy,received_ns,due_ns,sent_ns";
}

std::string to_csv(const PacketRecord& r) {
    return fmt::format("{},{},{},{},{},{},{:d},{:d},{},{},{}", r.inlet, r.flow, to_string(r.direction),
                       r.packet, r.bytes, to_string(r.fate), r.corrupted, r.copy, moment(r.received_ns),
                       moment(r.due_ns), moment(r.sent_ns));
}

}  // namespace thimble
