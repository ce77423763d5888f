// The ranks of an MPI job as workers. Each rank runs the same command line; rank 0 alone writes and speaks. The module that knows MPI is
// loaded only under mpirun, because many machines have no Open MPI.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace thimble {

// Where results are wanted: by rank 0, which writes them, or by each, because they decide how the work goes on.
enum class ResultsGo { kToFirst, kToAll };

// Items 0 to count - 1, the same in each rank. Results are bytes.
struct RankWork {
    std::size_t count = 0;
    unsigned threads = 1;  // of each rank
    std::function<std::string(std::size_t)> work;
    std::function<void(const std::string&)> take;  // in the order of the items
    const std::atomic<bool>* stop = nullptr;       // asked by rank 0
    ResultsGo results = ResultsGo::kToAll;
    // Text of all else that decides on the items, such as the rows that are there already. Another machine may have another one.
    std::string plan{};
};

class Ranks {
  public:
    virtual ~Ranks() = default;
    virtual std::size_t count() const = 0;
    // Returns once all ranks have come here.
    virtual void meet() = 0;
    // Each rank calls it. False if it was stopped before the last item. Throws in each rank what a worker threw in any, or that one
    // of them has other items.
    virtual bool run(const RankWork& work) = 0;
    // This rank stops working; it answers all requests with `why`.
    virtual void fail(const std::string& why) = 0;
};

// As mpirun says; without it 1 rank, which is 0.
int rank_count();
int own_rank();
// At the start of a program: ranks but the first say nothing, and draw nothing.
void quieten_other_ranks();
// At its end, with its exit code: that for mpirun. A rank but the first that failed tells rank 0, or says on stderr why the job ends.
int end_of_rank(int code);
// Where a command writes, before it looks there. Under mpirun the ranks meet here: rank 0 gets `out`, each other rank a copy of that
// folder's files, which goes when the program ends. Throws Error (usage) without the module.
std::filesystem::path join_ranks(const std::filesystem::path& out);
// Null where the ranks have not joined.
Ranks* joined_ranks();

}  // namespace thimble
