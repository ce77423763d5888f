// The tools of `thimble log`: a log's content for people, checks, repair.
#pragma once

#include <filesystem>
#include <string>

#include "common/log/mcap_writer.hpp"
#include "session/log/logged_file.hpp"

namespace thimble {

// "whole", or what is missing at its end.
std::string describe_end(const LoggedFile& file);
std::string describe_log(const LoggedFile& file);

// A whole file from one that was cut off or damaged.
struct RepairResult {
    McapScan scan;                // of the old file
    std::uint64_t messages = 0;   // in the new one
    std::uint64_t bytes_cut = 0;  // of the old one, behind the last whole record
};

// Everything of `file` that is whole, numbered anew. Does not finish the other.
McapScan copy_whole_records(Bytes file, McapWriter& to);

// Writes everything of `from` that is whole to the new file `to`, with an index. Throws Error: data, if there is nothing to
// repair; usage, if `to` exists; run failed, if it cannot be written.
RepairResult repair_log(const std::filesystem::path& from, const std::filesystem::path& to);

// Whether logs can be trusted, and whether what was sent adds up with what was received.

// One file alone.
struct FileFinding {
    std::uint64_t unreadable = 0;         // messages that no schema of Thimble's fits
    std::uint64_t backward = 0;           // log times that go back
    std::uint64_t stamps_backward = 0;    // sender's stamps that go back while its sequence goes on
    std::uint64_t missing_sent = 0;       // sequences that the sender's own log does not have
    std::vector<std::string> problems{};  // empty: it can be trusted
};
FileFinding check_file(const LoggedFile& file);

// One flow, where the logs of both ends are among the files; within the sequences that the sender's log has, at both ends of it.
struct FlowFinding {
    std::string topic;
    std::uint64_t sent = 0, received = 0;  // received: without repetitions
    std::uint64_t outside =
        0;  // sent before the receiver took anything in, or too late to arrive before it ended
    std::uint64_t lost = 0;          // sent and not received, as the logs have it: sent - received - outside
    std::uint64_t repeated = 0;      // received once more
    std::uint64_t out_of_order = 0;  // received after a later one
    std::uint64_t foreign = 0;       // received, but never sent
};
std::vector<FlowFinding> check_flows(const std::vector<std::unique_ptr<LoggedFile>>& files);

// A flow that goes through thimble-netem, beside what that has counted: two books, kept apart. A message that the
// other end's log lacks was lost with a known reason, or was under way when the programs ended.
struct RelayFinding {
    std::string topic;
    std::uint64_t lost = 0;   // by the logs
    std::uint64_t named = 0;  // by the relay, under all its names
    std::int64_t before = 0;  // sent, and never reached the relay
    std::int64_t within = 0;  // reached it, and is neither delivered nor lost under a name
    std::int64_t behind = 0;  // delivered, and never received
    std::string names{};      // "472 lost, 3 queue_full"
    std::string problem{};    // empty: the books agree
};
// The most messages of a flow that may be under way when the programs end.
inline constexpr std::int64_t kMostUnderWay = 100;
// `report`: what thimble-netem wrote with --report, or a run into nodes/. Only of flows whose both ends are in the logs. Throws
// Error (data) if it is no such report.
std::vector<RelayFinding> check_relay(const std::vector<FlowFinding>& flows,
                                      const std::filesystem::path& report);

}  // namespace thimble
