// Ranks of an MPI job as a pool. Rank 0 hands out blocks of cells, one for each that comes back, and takes the rows; the others
// ask for nothing else. Each rank has a pool of threads for the cells and one thread that speaks MPI and mostly sleeps. A rank
// that dies ends the job (mpirun's rule); what rank 0 has written by then stays.
#pragma once

#include "study/maps/worker_pool.hpp"

namespace thimble {

class RankPool final : public WorkerPool {
  public:
    // Of MPI_COMM_WORLD, in which every rank has as many threads.
    explicit RankPool(unsigned threads);

    bool leads() const { return rank_ == 0; }
    std::size_t hands() const override;
    void lead(const PoolWork& work) override;  // rank 0
    void serve(
        const std::function<std::string(const CellRange&)>& rows);  // the others, until rank 0 lets them go

  private:
    // With more ranks, answering them is all that rank 0 has time for.
    static constexpr int kWorkingLeader = 16;
    bool leader_works() const { return ranks_ <= kWorkingLeader; }

    int rank_ = 0, ranks_ = 1;
    unsigned threads_;
};

}  // namespace thimble
