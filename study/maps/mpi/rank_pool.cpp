#include "study/maps/mpi/rank_pool.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#define OMPI_SKIP_MPICXX 1  // its C++ bindings are no more
#include <mpi.h>

#include "study/maps/cell_pool.hpp"

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

// The cells that no rank has yet, in their order.
class Handout {
  public:
    explicit Handout(const PoolWork& work) : work_(work), next_(work.first) {}
    std::optional<CellRange> next() {
        if (closed_ || next_ >= work_.end) return std::nullopt;
        const CellRange range{next_, std::min(work_.block, work_.end - next_)};
        next_ += range.count;
        return range;
    }
    void close() { closed_ = true; }

  private:
    const PoolWork& work_;
    std::size_t next_;
    bool closed_ = false;
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
    Handout handout(work);
    CellPool own(leader_works() ? threads_ : 0, work.rows);
    std::size_t away = 0;  // blocks with other ranks
    const auto give_to = [&](int rank) {
        if (const auto range = handout.next()) {
            send(rank, kBlock, packed(*range, ""));
            ++away;
        }
    };
    bool stopped = false;
    for (bool more = true; more;) {
        if (!stopped && work.stop()) {
            stopped = true;
            handout.close();
        }
        while (own.given() < own.fill()) {
            const auto range = handout.next();
            if (!range) break;
            own.give(*range);
        }
        while (auto message = received()) {
            if (message->tag == kRows) {
                --away;
                work.take(range_in(*message), message->bytes.substr(sizeof(WireRange)));
            }
            give_to(message->from);
        }
        if (auto done = own.take(kNap)) work.take(done->range, std::move(done->rows));
        more = stopped ? false : own.given() > 0 || away > 0;
    }
    for (int rank = 1; rank < ranks_; ++rank) send(rank, kLetGo, "");
    for (int left = 1; left < ranks_;) {
        const auto message = received();
        if (!message) {
            if (auto done = own.take(kNap)) work.take(done->range, std::move(done->rows));
            continue;
        }
        if (message->tag == kRows) work.take(range_in(*message), message->bytes.substr(sizeof(WireRange)));
        if (message->tag == kLeft) ++left;
    }
}

void RankPool::serve(const std::function<std::string(const CellRange&)>& rows) {
    CellPool own(threads_, rows);
    for (std::size_t i = 0; i < own.fill(); ++i) send(0, kAsk, "");
    for (;;) {
        while (auto message = received()) {
            if (message->tag == kLetGo) {
                send(0, kLeft, "");
                return;
            }
            own.give(range_in(*message));
        }
        if (auto done = own.take(kNap)) send(0, kRows, packed(done->range, done->rows));
    }
}

}  // namespace thimble
