// The workers that compute the cells: threads of this program, or ranks of many. The rest of a map knows only this.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "study/maps/cells.hpp"
#include "study/ordered_workers.hpp"

namespace thimble {

// The work, and the receiver of its results.
struct PoolWork {
    std::size_t first = 0, end = 0, block = 1;  // cells [first, end), so many at a time
    std::function<std::string(const CellRange&)> rows;
    // In any order, from the thread that called lead().
    std::function<void(const CellRange&, std::string rows)> take;
    const std::atomic<bool>* stop = nullptr;  // outlives lead()

    std::size_t blocks() const { return (end - first + block - 1) / block; }
    CellRange range(std::size_t number) const {
        const std::size_t from = first + number * block;
        return {from, std::min(block, end - from)};
    }
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
    void lead(const PoolWork& work) override {
        OrderedWorkers<std::string> workers(
            work.blocks(), threads_, [&](std::size_t i) { return work.rows(work.range(i)); }, work.stop);
        for (std::size_t i = 0; i < work.blocks(); ++i) {
            std::optional<std::string> rows = workers.take();
            if (!rows) return;
            work.take(work.range(i), std::move(*rows));
        }
    }

  private:
    unsigned threads_;
};

}  // namespace thimble
