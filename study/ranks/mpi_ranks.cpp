// thimble-ranks.so, the only code that knows MPI. Rank 0 hands out items, takes the results, and passes each on to all ranks in the order
// of the items. Each rank has threads for the items and one thread that speaks MPI and mostly sleeps. A rank that dies ends the
// job (mpirun's rule); what rank 0 has written by then stays.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <exception>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#define OMPI_SKIP_MPICXX 1  // its C++ bindings are no more
#include <mpi.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "study/ranks/own_items.hpp"
#include "study/ranks/ranks.hpp"

namespace thimble {
namespace {

enum Tag : int { kBegin = 1, kAgreed, kItem, kDone, kFailed, kResult, kEnd, kGone };
enum class Ended : std::uint64_t { kComplete, kStopped, kFailed };

struct Message {
    int from = 0, tag = 0;
    std::uint64_t number = 0;  // of items, of an item, an exit code, or an Ended
    std::string bytes;
};

std::optional<Message> received() {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there == 0) return std::nullopt;
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    std::string wire(static_cast<std::size_t>(size), '\0');
    MPI_Recv(wire.data(), size, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    Message message{status.MPI_SOURCE, status.MPI_TAG, 0, {}};
    std::memcpy(&message.number, wire.data(), std::min(wire.size(), sizeof message.number));
    message.bytes = wire.substr(std::min(wire.size(), sizeof message.number));
    return message;
}

// Two ranks that send to each other at once would wait for ever in a send that blocks, so each message waits here until it has left.
struct Outgoing {
    std::string wire;
    MPI_Request request;
};

// Never destroyed: the last messages leave when the program ends.
std::list<Outgoing>& outbox() {
    static auto& messages = *new std::list<Outgoing>;
    return messages;
}

bool has_left(Outgoing& message) {
    int left = 0;
    MPI_Test(&message.request, &left, MPI_STATUS_IGNORE);
    return left != 0;
}

void send(int to, Tag tag, std::uint64_t number, const std::string& bytes = {}) {
    std::string wire(sizeof number, '\0');
    std::memcpy(wire.data(), &number, sizeof number);
    wire += bytes;
    outbox().remove_if(has_left);
    Outgoing& outgoing = outbox().emplace_back(Outgoing{std::move(wire), MPI_REQUEST_NULL});
    MPI_Isend(outgoing.wire.data(), static_cast<int>(outgoing.wire.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD,
              &outgoing.request);
}

// Text of count and plan, equal for equal items. All ranks are the same program.
std::string items_of(const RankWork& work) {
    return fmt::format("{} items of plan {:016x}", work.count, std::hash<std::string>{}(work.plan));
}

// Rank 0: distributes items.
class Lead {
  public:
    Lead(const RankWork& work, int ranks)
        : work_(work),
          ranks_(ranks),
          own_(ranks <= kWorkingLeader ? work.threads : 0, work.work),
          busy_(static_cast<std::size_t>(ranks), 0) {}

    bool run() {
        for (int rank = 1; rank < ranks_; ++rank) ask(rank, kBegin, work_.count, items_of(work_));
        while (taken_ < work_.count || away_ > 0 || !own_.empty()) {
            if (work_.stop != nullptr && *work_.stop) stopped_ = true;
            if (over() && away_ == 0 && own_.empty()) break;
            hand_out();
            while (auto message = received()) hear(*message);
            guarded([&] {
                if (auto done = own_.take()) take(done->item, std::move(done->result));
            });
        }
        const Ended how = failure_               ? Ended::kFailed
                          : taken_ < work_.count ? Ended::kStopped
                                                 : Ended::kComplete;
        for (int rank = 1; rank < ranks_; ++rank)
            send(rank, kEnd, static_cast<std::uint64_t>(how), failure_text());
        if (failure_) std::rethrow_exception(failure_);
        return how == Ended::kComplete;
    }

  private:
    // With more ranks, answering them is all that rank 0 has time for.
    static constexpr int kWorkingLeader = 16;
    // Results may wait for an earlier one, so many for each thread.
    static constexpr std::size_t kWindow = 16;

    bool over() const { return stopped_ || failure_ != nullptr; }
    bool left() const {
        const std::size_t hands = static_cast<std::size_t>(ranks_) * work_.threads;
        return !over() && next_ < std::min(work_.count, taken_ + kWindow * hands);
    }

    // Each thread has one item more than it works on.
    void hand_out() {
        for (std::size_t each = 1; each <= 2 * std::size_t{work_.threads}; ++each) {
            if (left() && own_.size() < each && own_.has_room()) own_.give(next_++);
            for (int rank = 1; rank < ranks_ && left(); ++rank) {
                if (busy_[static_cast<std::size_t>(rank)] >= each) continue;
                ask(rank, kItem, next_++);
            }
        }
    }

    // Each gets an answer: hear().
    void ask(int rank, Tag tag, std::uint64_t number, const std::string& bytes = {}) {
        send(rank, tag, number, bytes);
        ++busy_[static_cast<std::size_t>(rank)];
        ++away_;
    }

    void hear(const Message& message) {
        --busy_[static_cast<std::size_t>(message.from)];
        --away_;
        guarded([&] {
            if (message.tag == kFailed) throw Error(static_cast<ExitCode>(message.number), message.bytes);
            if (message.tag == kDone) take(message.number, message.bytes);
        });
    }

    void take(std::size_t item, std::string result) {
        waiting_.emplace(item, std::move(result));
        for (auto first = waiting_.begin(); first != waiting_.end() && first->first == taken_ && !failure_;
             first = waiting_.erase(first), ++taken_) {
            for (int rank = 1; rank < ranks_ && work_.results == ResultsGo::kToAll; ++rank)
                send(rank, kResult, taken_, first->second);
            work_.take(first->second);
        }
    }

    // The first failure counts. Items under way come to their end.
    template <class Step>
    void guarded(const Step& step) {
        try {
            step();
        } catch (...) {
            if (!failure_) failure_ = std::current_exception();
        }
    }

    std::string failure_text() const {
        if (!failure_) return {};
        try {
            std::rethrow_exception(failure_);
        } catch (const std::exception& error) {
            return error.what();
        }
    }

    const RankWork& work_;
    int ranks_;
    OwnItems own_;
    std::vector<std::size_t> busy_;  // items under way, by rank
    std::size_t next_ = 0, taken_ = 0, away_ = 0;
    std::map<std::size_t, std::string> waiting_;
    bool stopped_ = false;
    std::exception_ptr failure_;
};

class MpiRanks final : public Ranks {
  public:
    MpiRanks() {
        int threads = 0;
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &threads);
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    }
    // The other ranks wait until rank 0 has written all.
    ~MpiRanks() override {
        if (rank_ == 0) {
            for (int rank = 1; rank < ranks_; ++rank) send(rank, kGone, 0);
        } else {
            while (!gone_) wait_for_end();
        }
        for (Outgoing& message : outbox()) MPI_Wait(&message.request, MPI_STATUS_IGNORE);
        MPI_Finalize();
    }
    MpiRanks(const MpiRanks&) = delete;
    MpiRanks& operator=(const MpiRanks&) = delete;

    std::size_t count() const override { return static_cast<std::size_t>(ranks_); }
    void meet() override { MPI_Barrier(MPI_COMM_WORLD); }
    bool run(const RankWork& work) override { return rank_ == 0 ? Lead(work, ranks_).run() : follow(work); }
    void fail(const std::string& why) override { why_ = why; }

  private:
    bool follow(const RankWork& work) {
        OwnItems own(work.threads, work.work);
        try {
            return follow(work, own);
        } catch (const std::exception& error) {
            for (std::size_t left = gone_ ? 0 : own.size(); left > 0; --left) refuse(error.what());
            throw;
        }
    }

    bool follow(const RankWork& work, OwnItems& own) {
        for (;;) {
            while (auto message = received()) {
                if (message->tag == kBegin) agree(*message, work);
                if (message->tag == kItem) own.give(message->number);
                if (message->tag == kResult) work.take(message->bytes);
                if (message->tag == kEnd) return ended(*message);
                if (message->tag == kGone) {
                    gone_ = true;
                    throw Error(ExitCode::kRunFailed, "rank 0 has ended");
                }
            }
            answer(own);
        }
    }

    // Items of another plan would be other rows.
    void agree(const Message& begin, const RankWork& work) const {
        if (begin.bytes == items_of(work)) return send(0, kAgreed, 0);
        const Error error(ExitCode::kUsage,
                          "rank {} on {} has {}, rank 0 has {}: use the same folder of --out, session and "
                          "program on each machine",
                          rank_, machine(), items_of(work), begin.bytes);
        refuse(error.what(), error.code());
        throw error;
    }

    static std::string machine() {
        std::array<char, MPI_MAX_PROCESSOR_NAME> name{};
        int length = 0;
        MPI_Get_processor_name(name.data(), &length);
        return {name.data(), static_cast<std::size_t>(length)};
    }

    static void refuse(const std::string& why, ExitCode code = ExitCode::kRunFailed) {
        send(0, kFailed, static_cast<std::uint64_t>(code), why);
    }

    static void answer(OwnItems& own) {
        try {
            if (auto done = own.take()) send(0, kDone, done->item, done->result);
        } catch (const Error& error) {
            refuse(error.what(), error.code());
        } catch (const std::exception& error) {
            refuse(error.what());
        }
    }

    static bool ended(const Message& end) {
        const auto how = static_cast<Ended>(end.number);
        if (how == Ended::kFailed) throw Error(ExitCode::kRunFailed, end.bytes);
        return how == Ended::kComplete;
    }

    void wait_for_end() {
        if (const auto message = received()) {
            gone_ = message->tag == kGone;
            // Rank 0 waits for each answer.
            if (message->tag == kBegin || message->tag == kItem) refuse(why_);
        } else {
            nap();
        }
    }

    int rank_ = 0, ranks_ = 1;
    bool gone_ = false;
    std::string why_ = "a rank has ended before the others";
};

}  // namespace
}  // namespace thimble

extern "C" thimble::Ranks* make_thimble_ranks() { return new thimble::MpiRanks; }
