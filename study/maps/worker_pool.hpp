// The workers that compute the cells: threads of this program, or ranks of many. The rest of a map knows only this.
#pragma once

#include <functional>
#include <string>

#include "study/maps/cells.hpp"

namespace thimble {

// The work, and the receiver of its results.
struct PoolWork {
    std::size_t first = 0, end = 0, block = 1;  // cells [first, end), so many at a time
    std::function<std::string(const CellRange&)> rows;
    std::function<void(const CellRange&, std::string rows)>
        take;                    // in any order, from the thread that called lead()
    std::function<bool()> stop;  // asked now and again
};

class WorkerPool {
  public:
    virtual ~WorkerPool() = default;
    // Of all machines and threads together, to cut blocks by.
    virtual std::size_t hands() const = 0;
    // Returns when all is done or `stop` is true. A stop leaves the cells that have not begun, and perhaps those in work. Throws what a worker throws.
    virtual void lead(const PoolWork& work) = 0;
};

class ThreadPool final : public WorkerPool {
  public:
    explicit ThreadPool(unsigned threads) : threads_(threads) {}
    std::size_t hands() const override { return threads_; }
    void lead(const PoolWork& work) override;

  private:
    unsigned threads_;
};

}  // namespace thimble
