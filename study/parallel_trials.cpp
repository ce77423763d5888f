// run_trials: worker threads that take the next trial from a counter and leave its record in a window of
// slots, from which one thread takes them in order.
#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "session/virtual/virtual_session.hpp"
#include "study/study.hpp"

namespace thimble {
namespace {

class Pool {
  public:
    Pool(const SystemSettings& settings, std::span<const TrialConditions> trials, unsigned jobs,
         const std::atomic<bool>* stop)
        : settings_(settings), trials_(trials), stop_(stop), slots_(2 * std::size_t{jobs}) {
        for (unsigned i = 0; i < jobs; ++i) workers_.emplace_back([this] { work(); });
    }
    ~Pool() {
        {
            const std::lock_guard lock(mutex_);
            cancelled_ = true;
        }
        changed_.notify_all();
        for (std::thread& worker : workers_) worker.join();
    }
    Pool(const Pool&) = delete;
    Pool& operator=(const Pool&) = delete;

    // The record of trial `taken_`, empty if the pool was stopped before it was begun.
    std::optional<TrialRecord> take() {
        std::unique_lock lock(mutex_);
        auto& slot = slots_[taken_ % slots_.size()];
        changed_.wait(lock, [&] { return slot.has_value() || failure_ || (stopping() && next_ <= taken_); });
        if (failure_) std::rethrow_exception(failure_);
        if (!slot) return std::nullopt;
        std::optional<TrialRecord> record = std::exchange(slot, std::nullopt);
        ++taken_;
        lock.unlock();
        changed_.notify_all();
        return record;
    }

  private:
    bool stopping() const { return cancelled_ || (stop_ != nullptr && *stop_); }

    void work() {
        for (;;) {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] {
                return stopping() || next_ >= trials_.size() || next_ < taken_ + slots_.size();
            });
            if (stopping() || next_ >= trials_.size()) {
                changed_.notify_all();
                return;
            }
            const std::size_t mine = next_++;
            lock.unlock();
            run(mine);
            changed_.notify_all();
        }
    }

    void run(std::size_t mine) {
        try {
            TrialRecord record = run_virtual_trial(settings_, trials_[mine]);
            const std::lock_guard lock(mutex_);
            slots_[mine % slots_.size()] = std::move(record);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            failure_ = std::current_exception();
        }
    }

    const SystemSettings& settings_;
    std::span<const TrialConditions> trials_;
    const std::atomic<bool>* stop_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::optional<TrialRecord>> slots_;
    std::size_t next_ = 0, taken_ = 0;
    bool cancelled_ = false;
    std::exception_ptr failure_;
    std::vector<std::thread> workers_;
};

}  // namespace

unsigned thread_count(unsigned jobs) {
    return jobs != 0 ? jobs : std::max(1U, std::thread::hardware_concurrency());
}

bool run_trials(const SystemSettings& settings, std::span<const TrialConditions> trials, unsigned jobs,
                const std::atomic<bool>* stop, const std::function<void(const TrialRecord&)>& take) {
    Pool pool(settings, trials, jobs == 0 ? 1 : jobs, stop);
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const std::optional<TrialRecord> record = pool.take();
        if (!record) return false;
        take(*record);
    }
    return true;
}

}  // namespace thimble
