#include "netem/relay/packet_log.hpp"

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr Duration kPause = std::chrono::milliseconds{20};

}  // namespace

PacketLog::PacketLog(const std::filesystem::path& path, std::size_t room)
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
        if (queue_.push(gap)) gap_ = 0;
    }
    if (gap_ > 0 || !queue_.push(record)) {
        ++missing_;
        ++gap_;
    }
}

void PacketLog::finish() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    file_.flush();
    if (!file_) {
        throw Error(ExitCode::kData, "the packet log '{}' is incomplete: is the disk full?", path_.string());
    }
}

void PacketLog::run() {
    block_signals();
    for (bool stopping = false; !stopping;) {
        stopping = stop_;  // before the last look, so that nothing stays behind
        bool idle = true;
        // One by one: consume_all would free no room before the last of them is written.
        while (queue_.consume_one([this](const PacketRecord& record) { write(record); })) idle = false;
        if (idle && !stopping) wall_sleep(kPause);
    }
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
