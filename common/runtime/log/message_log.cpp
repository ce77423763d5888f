#include "common/runtime/log/message_log.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>
#include <utility>

#include <spdlog/spdlog.h>

#include "common/codec.hpp"
#include "common/error.hpp"
#include "common/log/byte_queue.hpp"
#include "common/log/mcap_writer.hpp"
#include "common/runtime/log/log_file.hpp"
#include "common/runtime/log/tapped_channel.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"

namespace thimble {
namespace {

// Four seconds of all a node's messages: longer than a disk delays the writer.
constexpr std::size_t kQueueBytes = std::size_t{4} << 20;
// Limits a chunk while the disk is slow.
constexpr std::size_t kMostChunkBytes = std::size_t{1} << 18;
// A lasting overflow is reported at most once a second.
constexpr unsigned kTurnsPerTelling = 25;
// In lock-step, where chunks must not depend on the wall clock. It is about a second of a session.
constexpr unsigned kGrantsPerFlush = 2000;

Bytes bytes_of(const std::string& text) {
    return {static_cast<const std::uint8_t*>(static_cast<const void*>(text.data())), text.size()};
}

// True if the descriptor became readable.
bool wait_for(int descriptor, Duration limit) {
    pollfd events{descriptor, POLLIN, 0};
    return ::poll(&events, 1, static_cast<int>(limit / std::chrono::milliseconds{1})) > 0;
}

// `granted`: in lock-step, where the log's times count from the session's start.
McapMap origin_notes(const LogOrigin& origin, const LogSettings& settings, SessionTime granted) {
    const ClockPair clocks = read_clock_pair();
    std::string boot =
        read_text_file("/proc/sys/kernel/random/boot_id");  // equal: one machine, one monotonic clock
    while (!boot.empty() && boot.back() == '\n') boot.pop_back();
    return {{"program", origin.program},
            {"version", kVersion},
            {"process", std::to_string(getpid())},
            {"machine_boot", boot},
            {"monotonic_ns", std::to_string(to_nanoseconds(granted == kNever ? clocks.before : granted))},
            {"realtime_ns", std::to_string(clocks.realtime_ns)},
            {"messages", to_string(settings.messages)},
            {"session_file", origin.config.string()}};
}

}  // namespace

std::filesystem::path log_path_of_trial(const std::filesystem::path& file, unsigned trial) {
    if (file.empty()) return {};
    const std::string name =
        fmt::format("{}_trial{:02}{}", file.stem().string(), trial, file.extension().string());
    return file.parent_path() / name;
}

struct MessageLog::Writing {
    explicit Writing(const std::filesystem::path& path)
        : file(path), writer(file, std::string("thimble ") + kVersion) {}
    LogFile file;
    McapWriter writer;
    std::uint16_t schema = 0;
    Message message;
};

MessageLog::MessageLog() : queue_(std::make_unique<ByteQueue>(kQueueBytes)), stop_(eventfd(0, EFD_CLOEXEC)) {
    if (stop_ < 0)
        throw Error(ExitCode::kRunFailed,
                    "cannot make an event descriptor for the log: too many open files?");
}

MessageLog::~MessageLog() {
    close();
    if (writing_ && syncs_) writing_->file.sync();
    ::close(stop_);
}

std::uint16_t MessageLog::add_flow(Port port, const char* direction) {
    flows_.push_back({port, direction});
    return static_cast<std::uint16_t>(flows_.size() - 1);
}

Channel* MessageLog::tap(Channel& channel, Port sent_to, Port received_at) {
    const std::uint16_t sent = add_flow(sent_to, "sent");
    const std::uint16_t received = add_flow(received_at, "received");
    taps_.push_back(std::make_unique<TappedChannel>(channel, *queue_, sent, received, granted_));
    return taps_.back().get();
}

void MessageLog::start(const std::filesystem::path& file, const LogOrigin& origin,
                       const LogSettings& settings) {
    std::error_code ignored;
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
    writing_ = std::make_unique<Writing>(file);
    McapWriter& writer = writing_->writer;
    writing_->schema = writer.add_schema(kWireSchemaName, "flatbuffer", wire_schema());
    writer.add_metadata("thimble", origin_notes(origin, settings, granted_));
    const auto now_ns = static_cast<std::uint64_t>(to_nanoseconds(wall_now()));
    const auto attach = [&](const std::filesystem::path& path) {
        const std::string text = read_text_file(path);
        writer.add_attachment({now_ns, path.filename().string(), "application/toml", bytes_of(text)});
    };
    if (!origin.config.empty()) attach(origin.config);
    for (const auto& path : origin.files) attach(path);
    counters_.file = file.string();
    if (granted_ != kNever) return;
    syncs_ = settings.sync_period > Duration{0};
    thread_ = std::thread([this] { write_until_stopped(); });
    if (syncs_) syncer_ = std::thread([this, period = settings.sync_period] { sync_until_stopped(period); });
}

void MessageLog::note(std::string name, McapMap pairs) {
    const std::lock_guard lock(notes_mutex_);
    notes_.push_back({std::move(name), std::move(pairs)});
}

std::string_view MessageLog::fault() const {
    return failed_.load(std::memory_order_acquire) ? std::string_view(fault_) : std::string_view{};
}

void MessageLog::take_time(SessionTime now) {
    granted_ = now;
    if (writing_ != nullptr) turn(++grants_ % kGrantsPerFlush == 0);
}

LogCounters MessageLog::close() {
    if (!thread_.joinable() && (granted_ == kNever || writing_ == nullptr)) return counters_;
    if (thread_.joinable()) {
        const std::uint64_t one = 1;
        static_cast<void>(::write(stop_, &one, sizeof one) == 0);
        thread_.join();
    } else {
        turn(true);
        end();
        granted_ = kNever;
    }
    if (syncer_.joinable()) syncer_.join();
    counters_.messages = writing_->writer.messages();
    counters_.bytes = writing_->writer.bytes();
    counters_.lost = lost();
    counters_.fault = fault();
    return counters_;
}

void MessageLog::write_until_stopped() {
    while (!wait_for(stop_, kLogPeriod)) turn(true);
    turn(true);
    end();
}

// A thread of its own, because a slow disk may block it for longer than a killed program may lose.
void MessageLog::sync_until_stopped(Duration period) const {
    while (!wait_for(stop_, period)) writing_->file.sync();
}

void MessageLog::turn(bool flushes) {
    std::vector<LogNote> notes;
    {
        const std::lock_guard lock(notes_mutex_);
        notes.swap(notes_);
    }
    try {
        if (!failed_) {
            for (const LogNote& note : notes) writing_->writer.add_metadata(note.name, note.pairs);
        }
        queue_->drain([this](const ByteQueue::Entry& entry, Bytes bytes) {
            write_message(entry.tag, entry.time_ns, bytes);
        });
        if (!failed_ && flushes) writing_->writer.flush();
        if (!failed_ && flushes) say_overflow(false);
    } catch (const Error& error) {
        fail(error.what());
    }
}

void MessageLog::say_overflow(bool now) {
    const std::uint64_t lost = queue_->lost();
    const bool due = turns_++ % kTurnsPerTelling == 0;
    if (lost == told_lost_ || !(due || now)) return;
    writing_->writer.add_metadata("overflow", {{"messages_lost", std::to_string(lost)},
                                               {"until_ns", std::to_string(to_nanoseconds(wall_now()))}});
    told_lost_ = lost;
}

void MessageLog::write_message(std::uint16_t tag, std::int64_t time_ns, Bytes bytes) {
    if (failed_) {
        ++dropped_;
        return;
    }
    McapWriter& writer = writing_->writer;
    const std::optional<Refusal> refusal = decode_into(bytes, writing_->message);
    const bool readable = !refusal || refusal == Refusal::kNotOneBody || refusal == Refusal::kNotFinite ||
                          refusal == Refusal::kOutOfRange;
    LoggedFlow& flow = flows_[tag];
    int& channel = readable ? flow.channel : flow.unreadable;
    try {
        if (channel < 0) {
            const std::string topic =
                std::string(thimble::flow(flow.port).topic) + (readable ? "" : "/unreadable");
            channel = writer.add_channel(readable ? writing_->schema : std::uint16_t{0}, topic,
                                         readable ? "flatbuffer" : "", {{"direction", flow.direction}});
        }
        if (writer.chunk_bytes() >= kMostChunkBytes) writer.flush();
    } catch (const Error&) {
        ++dropped_;  // this message too
        throw;
    }
    McapMessage message;
    message.channel = static_cast<std::uint16_t>(channel);
    message.log_time_ns = message.publish_time_ns = static_cast<std::uint64_t>(time_ns);
    if (readable) {
        message.sequence = writing_->message.header.sequence;
        message.publish_time_ns =
            static_cast<std::uint64_t>(to_nanoseconds(writing_->message.header.send_time));
    }
    message.data = bytes;
    writer.add_message(message);
}

std::uint64_t MessageLog::lost() const { return queue_->lost() + dropped_ + writing_->writer.forgotten(); }

void MessageLog::fail(const std::string& words) {
    spdlog::error(words);
    fault_ = words;
    failed_.store(true, std::memory_order_release);
}

// Tried also after a failure: the space that was given back may be enough for the index.
void MessageLog::end() {
    if (failed_) turn(false);  // counts what the failed turn left in the queue
    try {
        McapWriter& writer = writing_->writer;
        if (!failed_) say_overflow(true);
        writer.add_metadata("end",
                            {{"messages_lost", std::to_string(lost())}, {"fault", failed_ ? fault_ : ""}});
        writer.finish();
    } catch (const Error& error) {
        if (!failed_) fail(error.what());
    }
}

}  // namespace thimble
