// Writes the fate of each packet to a file, from a thread of its own, so that no disk delays a packet. The queue
// between is bounded. Records that do not fit are counted, and a `gap` record marks the place.
#pragma once

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <boost/core/noncopyable.hpp>
#include <boost/lockfree/spsc_queue.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/packet_record.hpp"

namespace thimble {

class PacketLog final : public PacketSink, boost::noncopyable {
  public:
    // Records between relay and file: a quarter of a second at a million packets per second.
    static constexpr std::size_t kRoom = std::size_t{1} << 18;

    // Binary records (packet_record.hpp), or text if the name ends in .csv. Starts the thread, which keeps the default
    // scheduling: make this object before asking for real time. Throws Error (data) if the file cannot be made.
    explicit PacketLog(const std::filesystem::path& path, std::size_t room = kRoom)
        : path_(path),
          text_(path.extension() == ".csv"),
          file_(path, std::ios::binary | std::ios::trunc),
          queue_(room) {
        if (!file_) {
            throw Error(ExitCode::kData, "cannot write the packet log '{}': does its folder exist?",
                        path.string());
        }
        if (text_) {
            file_ << record_csv_header() << '\n';
        } else {
            const auto header = log_header();
            file_.write(reinterpret_cast<const char*>(header.data()), header.size());
        }
        thread_ = std::thread([this] { run(); });
    }

    // writes what is left
    ~PacketLog() override {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
    }

    // from one thread only
    void add(const PacketRecord& record) override {
        last_ns_ = record.received_ns;
        if (gap_ > 0 && queue_.push(gap())) gap_ = 0;
        if (gap_ > 0 || !queue_.push(record)) {
            ++missing_;
            ++gap_;
        }
    }

    std::uint64_t missing() const override { return missing_; }
    // Writes what was added so far and ends the thread. Says why the file is incomplete, e.g. a full disk; empty: it is whole.
    std::string finish() {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
        if (gap_ > 0) write(gap());
        gap_ = 0;
        file_.flush();
        if (file_) return "";
        return fmt::format("the packet log '{}' is incomplete: is the disk full?", path_.string());
    }

  private:
    static constexpr Duration kPause = std::chrono::milliseconds{20};

    void run() {
        block_signals();
        for (bool stopping = false; !stopping;) {
            stopping = stop_;  // before the last look, so that nothing stays behind
            bool idle = true;
            // One by one: consume_all would free its room only at the end.
            while (queue_.consume_one([this](const PacketRecord& record) { write(record); })) idle = false;
            if (idle && !stopping) wall_sleep(kPause);
        }
    }

    PacketRecord gap() const { return {.packet = gap_, .received_ns = last_ns_, .fate = LoggedFate::kGap}; }

    void write(const PacketRecord& record) {
        if (text_) {
            file_ << to_csv(record) << '\n';
            return;
        }
        const auto bytes = encode(record);
        file_.write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }

    std::filesystem::path path_;
    bool text_;
    std::ofstream file_;
    boost::lockfree::spsc_queue<PacketRecord> queue_;
    std::uint64_t missing_ = 0, gap_ = 0;  // in all; since the last record that found room
    std::int64_t last_ns_ = 0;             // when the packet of the last record came
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace thimble
