#include "netem/relay/packet_log.hpp"

#include <bit>
#include <cassert>
#include <csignal>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr Duration kPause = std::chrono::milliseconds{20};

// Signals are for the thread that relays.
void block_signals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

RecordQueue::RecordQueue(std::size_t room)
    : records_(std::make_unique_for_overwrite<PacketRecord[]>(room)), mask_(room - 1) {
    assert(std::has_single_bit(room));
}

bool RecordQueue::add(const PacketRecord& record) {
    const std::uint64_t at = added_.load(std::memory_order_relaxed);
    if (at - taken_.load(std::memory_order_acquire) > mask_) return false;
    records_[at & mask_] = record;
    added_.store(at + 1, std::memory_order_release);
    return true;
}

bool RecordQueue::take(PacketRecord& record) {
    const std::uint64_t at = taken_.load(std::memory_order_relaxed);
    if (at == added_.load(std::memory_order_acquire)) return false;
    record = records_[at & mask_];
    taken_.store(at + 1, std::memory_order_release);
    return true;
}

PacketLog::PacketLog(const std::filesystem::path& path, std::size_t room)
    : path_(path),
      text_(path.extension() == ".csv"),
      file_(path, std::ios::binary | std::ios::trunc),
      queue_(room) {
    if (!file_) {
        throw Error(ExitCode::kData,
                    fmt::format("cannot write the packet log '{}': does its folder exist?", path.string()));
    }
    if (text_) {
        file_ << record_csv_header() << '\n';
    } else {
        const auto header = log_header();
        file_.write(reinterpret_cast<const char*>(header.data()), header.size());
    }
    thread_ = std::thread([this] { run(); });
}

PacketLog::~PacketLog() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
}

void PacketLog::add(const PacketRecord& record) {
    if (gap_ > 0) {
        PacketRecord gap;
        gap.packet = gap_;
        gap.received_ns = record.received_ns;
        gap.fate = LoggedFate::kGap;
        if (queue_.add(gap)) gap_ = 0;
    }
    if (gap_ > 0 || !queue_.add(record)) {
        ++missing_;
        ++gap_;
    }
}

void PacketLog::finish() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    file_.flush();
    if (!file_) {
        throw Error(ExitCode::kData,
                    fmt::format("the packet log '{}' is incomplete: is the disk full?", path_.string()));
    }
}

void PacketLog::run() {
    block_signals();
    for (bool stopping = false; !stopping;) {
        stopping = stop_;  // before the last look, so that nothing stays behind
        if (!write_waiting() && !stopping) wall_sleep(kPause);
    }
}

bool PacketLog::write_waiting() {
    PacketRecord record;
    bool any = false;
    while (queue_.take(record)) {
        write(record);
        any = true;
    }
    return any;
}

void PacketLog::write(const PacketRecord& record) {
    if (text_) {
        file_ << to_csv(record) << '\n';
        return;
    }
    const auto bytes = encode(record);
    file_.write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

}  // namespace thimble
