// Threads that work on items side by side, and hand the results over in the order of the items. At most two results per thread
// wait, so that memory does not grow with the number of items.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace thimble {

// The number of threads for `jobs`: 0 is one per core, if that is known.
inline unsigned thread_count(unsigned jobs) {
    return jobs != 0 ? jobs : std::max(1U, std::thread::hardware_concurrency());
}

template <class Result>
class OrderedWorkers {
  public:
    // work(i) gives the result of item i < count; several threads call it. `stop`, where it is not null, begins no item once it is
    // true, and outlives the workers.
    OrderedWorkers(std::size_t count, unsigned threads, std::function<Result(std::size_t)> work,
                   const std::atomic<bool>* stop = nullptr)
        : count_(count), work_(std::move(work)), stop_(stop), slots_(2 * std::size_t{std::max(1U, threads)}) {
        start(std::max(1U, threads));
    }
    ~OrderedWorkers() {
        {
            const std::lock_guard lock(mutex_);
            cancelled_ = true;
        }
        changed_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }
    OrderedWorkers(const OrderedWorkers&) = delete;
    OrderedWorkers& operator=(const OrderedWorkers&) = delete;

    // The next item's result; none if `stop` came before the item began. Throws what a thread threw. Call at most `count` times.
    std::optional<Result> take() {
        std::unique_lock lock(mutex_);
        auto& slot = slots_[taken_ % slots_.size()];
        changed_.wait(lock, [&] { return slot.has_value() || failure_ || (stopping() && next_ <= taken_); });
        if (failure_) std::rethrow_exception(failure_);
        if (!slot) return std::nullopt;
        std::optional<Result> result = std::exchange(slot, std::nullopt);
        ++taken_;
        lock.unlock();
        changed_.notify_all();
        return result;
    }

  private:
    // Where the system gives no more threads, fewer do the same work.
    void start(unsigned threads) {
        threads_.reserve(threads);
        try {
            while (threads_.size() < threads) threads_.emplace_back([this] { run(); });
        } catch (const std::system_error&) {
            if (threads_.empty()) throw;
        }
    }

    bool stopping() const { return cancelled_ || (stop_ != nullptr && *stop_); }

    void run() {
        for (;;) {
            std::unique_lock lock(mutex_);
            changed_.wait(lock,
                          [&] { return stopping() || next_ >= count_ || next_ < taken_ + slots_.size(); });
            if (stopping() || next_ >= count_) {
                changed_.notify_all();
                return;
            }
            const std::size_t mine = next_++;
            lock.unlock();
            work_on(mine);
            changed_.notify_all();
        }
    }

    void work_on(std::size_t mine) {
        try {
            Result result = work_(mine);
            const std::lock_guard lock(mutex_);
            slots_[mine % slots_.size()] = std::move(result);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            failure_ = std::current_exception();
        }
    }

    std::size_t count_;
    std::function<Result(std::size_t)> work_;
    const std::atomic<bool>* stop_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::optional<Result>> slots_;
    std::size_t next_ = 0, taken_ = 0;
    bool cancelled_ = false;
    std::exception_ptr failure_;
    std::vector<std::thread> threads_;
};

}  // namespace thimble
