// A node's program writes at its end a report (JSON), and puts parts of it into its log.
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>

#include "common/flow.hpp"
#include "common/runtime/log/message_log.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/sockets.hpp"

namespace thimble {

// `overruns`: runs of missed deadlines as long as [runtime] allows.
nlohmann::ordered_json describe_program(const NodeProgram& program, const NodeInstance& instance,
                                        const Sockets& sockets, const FlowCounters& counters,
                                        const LoopStatistics& loop, std::uint64_t overruns);
// The report's `log`.
nlohmann::ordered_json describe_log(const LogCounters& log);
// In the log, too, which policy for silent inputs acted.
void note_stale(MessageLog& log, const nlohmann::ordered_json& report);

}  // namespace thimble
