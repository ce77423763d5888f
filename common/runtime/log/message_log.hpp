// A program's log of its messages (docs/log.md). Its loop copies each datagram into a queue; a thread of its own, without
// real-time scheduling, writes the queue to the file every kLogPeriod, and another one asks the disk to have it.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/channel.hpp"
#include "common/log/log_settings.hpp"
#include "common/log/mcap_bytes.hpp"
#include "common/log/recorder.hpp"
#include "common/network_settings.hpp"

namespace thimble {

class ByteQueue;

// A killed program loses what came since; docs/log.md promises 100 ms.
inline constexpr Duration kLogPeriod = std::chrono::milliseconds{40};

struct LogCounters {
    std::string file;            // empty: nothing was to be written
    std::uint64_t messages = 0;  // in the file
    std::uint64_t bytes = 0;     // of the file
    std::uint64_t lost = 0;      // no room in the queue, or none on the disk
    std::string fault;           // why not all could be written; empty: it could
};

// A log's facts about the program that writes it.
struct LogOrigin {
    std::string program;                       // "thimble-master"
    std::filesystem::path config;              // attached, if there is one
    std::vector<std::filesystem::path> files;  // attached with it
};

// In lock-step each trial has a file of its own, "thimble-master_50ms_trial02.mcap", because the session's clock
// begins anew with each. Empty: `file` is.
std::filesystem::path log_path_of_trial(const std::filesystem::path& file, unsigned trial);

class MessageLog final : public Recorder, boost::noncopyable {
  public:
    MessageLog();
    ~MessageLog();

    // A channel in front of `channel`, whose datagrams are written down as of the flows that arrive at these ports.
    // Only before start().
    Channel* tap(Channel& channel, Port sent_to, Port received_at);

    // Throws Error (usage) if the file cannot be created. Folders on the way are.
    void start(const std::filesystem::path& file, const LogOrigin& origin, const LogSettings& settings);
    bool running() const { return thread_.joinable(); }
    // In lock-step, first before start(): from now on messages bear this time. Those before it go to the file here, because a thread of
    // its own would write other bytes each time.
    void take_time(SessionTime now);
    // A metadata record among the messages. Seldom: it allocates.
    void note(std::string name, McapMap pairs);
    // Writes all that is there, index and end. The destructor waits for the disk.
    LogCounters close();

    std::string_view fault() const override;

  private:
    struct Writing;
    struct LogNote {
        std::string name;
        McapMap pairs;
    };
    std::uint16_t add_flow(Port port, const char* direction);
    void write_until_stopped();
    void sync_until_stopped(Duration period) const;
    void turn(bool flushes);
    void say_overflow(bool now);
    void write_message(std::uint16_t tag, std::int64_t time_ns, Bytes bytes);
    void fail(const std::string& words);
    void end();
    std::uint64_t lost() const;

    struct LoggedFlow {
        Port port{};
        const char* direction = "";
        int channel = -1, unreadable = -1;  // in the file, once there was a message
    };
    SessionTime granted_ = kNever;  // the wall clock's time holds
    std::unique_ptr<ByteQueue> queue_;
    std::vector<LoggedFlow> flows_;
    std::vector<std::unique_ptr<Channel>> taps_;
    std::mutex notes_mutex_;
    std::vector<LogNote> notes_;
    std::unique_ptr<Writing> writing_;
    std::atomic<bool> failed_{false};
    std::string fault_;  // written once, before failed_
    std::uint64_t dropped_ = 0, told_lost_ = 0;
    unsigned turns_ = 0, grants_ = 0;
    int stop_ = -1;  // an eventfd: both threads wait for it
    std::thread thread_, syncer_;
    LogCounters counters_;
    bool syncs_ = false;
};

}  // namespace thimble
