// A log of one program (docs/log.md): its origin, its topics and its messages.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/log/mcap_reader.hpp"

namespace thimble {

// The bytes of a file, as long as this lives.
class MappedFile : boost::noncopyable {
  public:
    // Throws Error (data) if it cannot be read.
    explicit MappedFile(const std::filesystem::path& path);
    ~MappedFile();
    Bytes bytes() const { return bytes_; }

  private:
    Bytes bytes_;
};

// Of one channel of the file.
struct LoggedTopic {
    std::string topic;
    bool sent = false;      // by the program that wrote the file; else received
    bool readable = false;  // its messages verify as thimble.wire.Packet
    std::uint64_t messages = 0;
};

struct LogAttachment {
    std::string name;
    std::size_t bytes = 0;
};

struct LogMetadata {
    std::string name;
    McapMap pairs;
};

class LoggedFile {
  public:
    // Reads all of it once. Throws Error (data) if it is no MCAP file. Of a cut or damaged file, scan() reports the damage.
    explicit LoggedFile(const std::filesystem::path& path) : LoggedFile(path, path.stem().string()) {}
    LoggedFile(const std::filesystem::path& path, std::string name);

    const std::filesystem::path& path() const { return path_; }
    // "thimble-master_50ms" of "nodes/thimble-master_50ms.mcap"; open_logs() puts folders before it.
    const std::string& name() const { return name_; }
    Bytes bytes() const { return file_.bytes(); }
    const McapScan& scan() const { return scan_; }
    const std::map<std::uint16_t, LoggedTopic>& topics() const { return topics_; }
    const std::vector<LogMetadata>& metadata() const { return metadata_; }
    const std::vector<LogAttachment>& attachments() const { return attachments_; }
    // Of the first metadata record of that name; empty if there is none.
    std::string value(std::string_view record, std::string_view key) const;
    const std::string& library() const { return library_; }
    std::uint64_t first_ns() const { return first_ns_; }
    std::uint64_t last_ns() const { return last_ns_; }
    // Number of messages that the writer lost, from its last note.
    std::uint64_t lost() const;

    using Use = std::function<void(const LoggedTopic&, const McapMessage&)>;
    void for_each(const Use& use) const;

  private:
    class Reading;
    std::filesystem::path path_;
    std::string name_;
    MappedFile file_;
    McapScan scan_;
    std::string library_;
    std::map<std::uint16_t, LoggedTopic> topics_;
    std::vector<LogMetadata> metadata_;
    std::vector<LogAttachment> attachments_;
    std::uint64_t first_ns_ = 0, last_ns_ = 0;
};

// Files of one name get as many of their folders before it as tell them apart: "a/nodes/session_50ms". Throws Error: data, as
// LoggedFile; usage, if a file is there twice.
std::vector<std::unique_ptr<LoggedFile>> open_logs(const std::vector<std::string>& paths);

}  // namespace thimble
