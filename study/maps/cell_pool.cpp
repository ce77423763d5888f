#include "study/maps/cell_pool.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "study/maps/worker_pool.hpp"

namespace thimble {

CellPool::CellPool(unsigned threads, std::function<std::string(const CellRange&)> rows)
    : rows_(std::move(rows)) {
    threads_.reserve(threads);
    for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

CellPool::~CellPool() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    asked_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void CellPool::give(const CellRange& range) {
    ++given_;
    {
        const std::lock_guard lock(mutex_);
        waiting_.push_back(range);
    }
    asked_.notify_one();
}

std::optional<DoneCells> CellPool::take(Duration wait) {
    std::unique_lock lock(mutex_);
    answered_.wait_for(lock, wait, [&] { return !done_.empty() || failure_; });
    if (failure_) std::rethrow_exception(failure_);
    if (done_.empty()) return std::nullopt;
    DoneCells done = std::move(done_.front());
    done_.pop_front();
    --given_;
    return done;
}

void CellPool::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        asked_.wait(lock, [&] { return ends_ || !waiting_.empty(); });
        if (ends_) return;
        DoneCells done;
        done.range = waiting_.front();
        waiting_.pop_front();
        lock.unlock();
        std::exception_ptr failure;
        try {
            done.rows = rows_(done.range);
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        if (failure) failure_ = failure;
        if (!failure) done_.push_back(std::move(done));
        answered_.notify_one();
    }
}

void ThreadPool::lead(const PoolWork& work) {
    constexpr Duration kPatient = std::chrono::milliseconds{100};  // between two looks at stop
    CellPool pool(threads_, work.rows);
    std::size_t next = work.first;
    while (next < work.end || pool.given() > 0) {
        if (work.stop()) return;
        for (; next < work.end && pool.given() < pool.fill(); next += work.block)
            pool.give({next, std::min(work.block, work.end - next)});
        if (auto done = pool.take(kPatient)) work.take(done->range, std::move(done->rows));
    }
}

}  // namespace thimble
