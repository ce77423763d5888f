// Whether logs can be trusted, and whether what was sent adds up with what was received.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "experiment/log/logged_file.hpp"

namespace thimble {

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
    std::uint64_t lost = 0;                // sent = received + lost
    std::uint64_t repeated = 0;            // received once more
    std::uint64_t out_of_order = 0;        // received after a later one
    std::uint64_t foreign = 0;             // received, but never sent
};
std::vector<FlowFinding> check_flows(const std::vector<std::unique_ptr<LoggedFile>>& files);

}  // namespace thimble
