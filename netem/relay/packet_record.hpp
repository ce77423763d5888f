// The fate of one packet in a packet log: 48 bytes, little-endian.
//
//   offset  size  field
//        0     8  packet      number within its flow and direction, from 0; fate `gap`: how many records are missing
//        8     8  received    ns, CLOCK_MONOTONIC: when the kernel had it
//       16     8  due         ns; 0 if it never had a due time
//       24     8  sent        ns: when the system call that sent it had returned; 0 if it was not sent
//       32     4  flow        number of the flow at its inlet, from 0
//       36     4  bytes       of the datagram
//       40     2  inlet       which --listen, from 0
//       42     1  direction   0 up (client to server), 1 down
//       43     1  fate        LoggedFate
//       44     1  flags       1: bits were flipped, 2: the second copy of two
//       45     3  reserved    0
//
// A file begins with 16 bytes: "THIMBLEN", version 1 and record size 48 as 4 bytes each.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "netem/link_observer.hpp"

namespace thimble {

enum class RelayDirection : std::uint8_t { kUp = 0, kDown = 1 };
std::string_view to_string(RelayDirection direction);

enum class LoggedFate : std::uint8_t {
    kSent = 0,
    kLost = 1,        // the loss model, or a trace
    kOutage = 2,      // received while nothing gets through
    kOversized = 3,   // empty, which a relay cannot tell from nothing
    kQueueFull = 4,   // the transmitter's queue
    kOverflowed = 5,  // too many in flight
    kRefused = 6,     // the kernel did not take it when it was due
    kGap = 7,         // the log could not keep up
};
inline constexpr std::size_t kLoggedFates = 8;
constexpr LoggedFate fate_of(DropReason reason) {
    return static_cast<LoggedFate>(1 + static_cast<std::uint8_t>(reason));
}
static_assert(fate_of(DropReason::kLost) == LoggedFate::kLost);
static_assert(fate_of(DropReason::kOutage) == LoggedFate::kOutage);
static_assert(fate_of(DropReason::kOversized) == LoggedFate::kOversized);
static_assert(fate_of(DropReason::kQueueFull) == LoggedFate::kQueueFull);
static_assert(fate_of(DropReason::kOverflowed) == LoggedFate::kOverflowed);
std::string_view to_string(LoggedFate fate);

struct PacketRecord {
    std::uint64_t packet = 0;
    std::int64_t received_ns = 0, due_ns = 0, sent_ns = 0;
    std::uint32_t flow = 0, bytes = 0;
    std::uint16_t inlet = 0;
    RelayDirection direction = RelayDirection::kUp;
    LoggedFate fate = LoggedFate::kSent;
    bool corrupted = false, copy = false;

    bool operator==(const PacketRecord&) const = default;
};

// Receives the records. Called from the thread that relays, once per packet: must be quick and never wait.
class PacketSink {
  public:
    virtual ~PacketSink() = default;
    virtual void add(const PacketRecord& record) = 0;
    // Records that found no room.
    virtual std::uint64_t missing() const { return 0; }
};

// Of a packet that left its link: `accepted` says whether the kernel took it.
PacketRecord record_of(const Departure& departure, SessionTime sent, bool accepted);

// Records what a link drops. The fields that a link does not know are those of `fixed`.
class DropLog final : public LinkObserver {
  public:
    DropLog(PacketSink& log, const PacketRecord& fixed) : log_(&log), fixed_(fixed) {}
    void on_drop(std::uint64_t packet, SessionTime received, std::size_t bytes, DropReason reason) override;

  private:
    PacketSink* log_;
    PacketRecord fixed_;
};

inline constexpr std::size_t kRecordBytes = 48;
inline constexpr std::size_t kLogHeaderBytes = 16;

std::array<std::uint8_t, kLogHeaderBytes> log_header();
// Throws Error (data) that says what is wrong with it; `name` is the file's.
void check_log_header(std::span<const std::uint8_t> bytes, const std::string& name);

std::array<std::uint8_t, kRecordBytes> encode(const PacketRecord& record);
// Nothing if the bytes are no record.
std::optional<PacketRecord> decode_record(std::span<const std::uint8_t, kRecordBytes> bytes);

std::string_view record_csv_header();
std::string to_csv(const PacketRecord& record);  // one line, without its end

}  // namespace thimble
