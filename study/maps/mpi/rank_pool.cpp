#include "study/maps/mpi/rank_pool.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <future>
#include <list>
#include <optional>
#include <string>
#include <utility>

#define OMPI_SKIP_MPICXX 1  // its C++ bindings are no more
#include <mpi.h>

#include "common/time.hpp"

namespace thimble {
namespace {

enum Tag : int { kAsk = 1, kBlock, kRows, kLetGo, kLeft };

// How long a message may wait. A blocking receive of Open MPI would use up a core that could work out cells.
constexpr Duration kNap = std::chrono::microseconds{500};

using WireRange = std::array<std::uint64_t, 2>;  // first, count

struct Message {
    int from = 0, tag = 0;
    std::string bytes;
};

std::optional<Message> received() {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there == 0) return std::nullopt;
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    Message message{status.MPI_SOURCE, status.MPI_TAG, std::string(static_cast<std::size_t>(size), '\0')};
    MPI_Recv(message.bytes.data(), size, MPI_BYTE, message.from, message.tag, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    return message;
}

void send(int to, Tag tag, const std::string& bytes) {
    MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}

std::string packed(const CellRange& range, const std::string& rows) {
    const WireRange wire{range.first, range.count};
    std::string bytes(sizeof wire, '\0');
    std::memcpy(bytes.data(), wire.data(), sizeof wire);
    return bytes + rows;
}

CellRange range_in(const Message& message) {
    WireRange wire{};
    std::memcpy(wire.data(), message.bytes.data(), std::min(sizeof wire, message.bytes.size()));
    return {wire[0], wire[1]};
}

struct DoneCells {
    CellRange range;
    std::string rows;
};

// The blocks of this rank, each in a thread of its own, so many at a time. Its end waits for those that are under way.
class OwnBlocks {
  public:
    OwnBlocks(unsigned threads, std::function<std::string(const CellRange&)> rows)
        : threads_(threads), rows_(std::move(rows)) {}

    // For each thread one more at hand than it works on.
    bool has_room() const { return waiting_.size() + running_.size() < 2 * threads_; }
    bool empty() const { return waiting_.empty() && running_.empty(); }
    void give(const CellRange& range) {
        waiting_.push_back(range);
        start();
    }
    // A block that has been done; nothing, after a nap, if there is none. Throws what a worker threw.
    std::optional<DoneCells> take() {
        const auto done = std::find_if(running_.begin(), running_.end(), [](const Running& block) {
            return block.rows.wait_for(Duration::zero()) == std::future_status::ready;
        });
        if (done == running_.end()) {
            (running_.empty() ? idle_ : running_.front().rows).wait_for(kNap);
            return std::nullopt;
        }
        DoneCells cells{done->range, done->rows.get()};
        running_.erase(done);
        start();
        return cells;
    }

  private:
    struct Running {
        CellRange range;
        std::future<std::string> rows;
    };
    void start() {
        for (; running_.size() < threads_ && !waiting_.empty(); waiting_.pop_front())
            running_.push_back({waiting_.front(), std::async(std::launch::async, rows_, waiting_.front())});
    }

    std::size_t threads_;
    std::function<std::string(const CellRange&)> rows_;
    std::deque<CellRange> waiting_;
    std::list<Running> running_;
    std::promise<std::string> never_;
    std::future<std::string> idle_ = never_.get_future();  // to wait for where no block runs
};

}  // namespace

RankPool::RankPool(unsigned threads) : threads_(threads) {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
}

std::size_t RankPool::hands() const {
    return static_cast<std::size_t>(ranks_ - (leader_works() ? 0 : 1)) * threads_;
}

void RankPool::lead(const PoolWork& work) {
    OwnBlocks own(leader_works() ? threads_ : 0, work.rows);
    std::size_t next = 0, away = 0;  // the first block that no rank has yet; blocks with other ranks
    bool stopped = false;
    const auto left = [&] { return !stopped && next < work.blocks(); };
    const auto take_own = [&] {
        if (auto done = own.take()) work.take(done->range, std::move(done->rows));
    };
    while (!stopped && (left() || !own.empty() || away > 0)) {
        stopped = work.stop != nullptr && *work.stop;
        while (left() && own.has_room()) own.give(work.range(next++));
        while (auto message = received()) {
            if (message->tag == kRows) {
                --away;
                work.take(range_in(*message), message->bytes.substr(sizeof(WireRange)));
            }
            if (left()) {
                send(message->from, kBlock, packed(work.range(next++), ""));
                ++away;
            }
        }
        take_own();
    }
    for (int rank = 1; rank < ranks_; ++rank) send(rank, kLetGo, "");
    for (int gone = 1; gone < ranks_;) {
        const auto message = received();
        if (!message) {
            take_own();
            continue;
        }
        if (message->tag == kRows) work.take(range_in(*message), message->bytes.substr(sizeof(WireRange)));
        if (message->tag == kLeft) ++gone;
    }
}

void RankPool::serve(const std::function<std::string(const CellRange&)>& rows) {
    OwnBlocks own(threads_, rows);
    for (unsigned i = 0; i < 2 * threads_; ++i) send(0, kAsk, "");
    for (;;) {
        while (auto message = received()) {
            if (message->tag == kLetGo) {
                send(0, kLeft, "");
                return;
            }
            own.give(range_in(*message));
        }
        if (auto done = own.take()) send(0, kRows, packed(done->range, done->rows));
    }
}

}  // namespace thimble
