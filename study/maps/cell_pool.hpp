// Threads that work off blocks of cells as they are given, in any order.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/time.hpp"
#include "study/maps/cells.hpp"

namespace thimble {

struct DoneCells {
    CellRange range;
    std::string rows;
};

class CellPool {
  public:
    CellPool(unsigned threads, std::function<std::string(const CellRange&)> rows);
    ~CellPool();  // waits for what is under way; the rest is left
    CellPool(const CellPool&) = delete;
    CellPool& operator=(const CellPool&) = delete;

    void give(const CellRange& range);
    // A block that has been done; nothing if none was within `wait`. Throws what a worker threw.
    std::optional<DoneCells> take(Duration wait);
    std::size_t given() const { return given_; }  // and not taken yet
    // Enough to have for each thread one more at hand than it works on.
    std::size_t fill() const { return 2 * threads_.size(); }

  private:
    void work();

    std::function<std::string(const CellRange&)> rows_;
    std::mutex mutex_;
    std::condition_variable asked_, answered_;
    std::deque<CellRange> waiting_;
    std::deque<DoneCells> done_;
    std::exception_ptr failure_;
    bool ends_ = false;
    std::size_t given_ = 0;
    std::vector<std::thread> threads_;
};

}  // namespace thimble
