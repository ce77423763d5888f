// Logs as tables, for other programs.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/csv/csv_file.hpp"
#include "session/log/merged_log.hpp"
#include "session/log/packet_fields.hpp"

namespace thimble {

using LoggedFiles = std::vector<std::unique_ptr<LoggedFile>>;

// One table per file, topic and kind of message in the folder, which is made: FILE.TOPIC.KIND.csv, of topics that
// begin with `topic`. Returns how many. FILE is the name that open_logs() gave. Throws Error: usage, if one exists;
// run failed, if one cannot be written.
std::size_t export_csv(const LoggedFiles& files, const std::filesystem::path& folder,
                       const std::string& topic);

// One group per file, topic and kind of message, one dataset per column, with attributes `unit` and `values` (of enums), in the
// new file. Throws Error: usage, if it exists; run failed, if it cannot be written.
std::size_t export_hdf5(const LoggedFiles& files, const std::filesystem::path& path,
                        const std::string& topic);

struct Ros2Written {
    std::size_t topics = 0;
    // The requested data that no log holds, each with the program whose log would hold it, in words.
    std::vector<std::string> missing;
    bool events_only = false;
};

// The same movements, forces and events as ROS 2 messages (docs/interoperability.md) in a new MCAP file of profile "ros2"; the logs' topics
// that begin with `topic`. Throws Error: usage, if it exists, or as merge_logs(); run failed, if it cannot be written.
Ros2Written export_ros2(const LoggedFiles& files, const std::filesystem::path& path,
                        const std::string& topic);

// A program for Wireshark that shows messages in the clear by field, as text in Lua.
std::string wireshark_dissector();

// One message as a JSON object, or for people; `zero_ns` is what their times count from.
std::string to_json(const MergedMessage& message, const PacketFields& fields);
std::string to_line(const MergedMessage& message, const PacketFields& fields, std::int64_t zero_ns);

}  // namespace thimble
