// Writes what becomes of each packet to a file, from a thread of its own, so that no disk ever holds up a packet. The
// queue between is bounded; what finds no room is counted, and a `gap` record marks the place.
#pragma once

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include <boost/core/noncopyable.hpp>
#include <boost/lockfree/spsc_queue.hpp>

#include "netem/relay/packet_record.hpp"

namespace thimble {

class PacketLog final : public PacketSink, boost::noncopyable {
  public:
    // Records between relay and file: a quarter of a second at a million packets per second.
    static constexpr std::size_t kRoom = std::size_t{1} << 18;

    // Binary records (packet_record.hpp), or text if the name ends in .csv. Starts the thread, which keeps the default
    // scheduling: make this object before asking for real time. Throws Error (data) if the file cannot be made.
    explicit PacketLog(const std::filesystem::path& path, std::size_t room = kRoom);
    ~PacketLog() override;  // writes what is left

    void add(const PacketRecord& record) override;  // from one thread only
    std::uint64_t missing() const override { return missing_; }
    // Writes what was added so far and ends the thread. Throws Error (data) if a write failed, e.g. a full disk.
    void finish();

  private:
    void run();
    void write(const PacketRecord& record);

    std::filesystem::path path_;
    bool text_;
    std::ofstream file_;
    boost::lockfree::spsc_queue<PacketRecord> queue_;
    std::uint64_t missing_ = 0, gap_ = 0;  // in all; since the last record that found room
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace thimble
