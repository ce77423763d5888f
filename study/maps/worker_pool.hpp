// Who works out the cells: threads of this program, or ranks of many. The rest of a map knows only this.
#pragma once

#include <functional>
#include <string>

#include "study/maps/cells.hpp"

namespace thimble {

// What there is to do, and what becomes of it.
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
    // Until all is done, or stop says so: what was not begun is left, what is under way may be. What a worker throws is thrown.
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
