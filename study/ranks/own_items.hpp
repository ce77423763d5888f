// The items of one rank, each in a thread of its own, so many at a time.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <list>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace thimble {

// How long a message may wait. A blocking receive of Open MPI would use up a core that could work.
inline constexpr std::chrono::microseconds kNap{500};
inline void nap() {
    std::promise<void> never;
    never.get_future().wait_for(kNap);
}

struct DoneItem {
    std::size_t item = 0;
    std::string result;
};

// The destructor waits for items in progress.
class OwnItems {
  public:
    OwnItems(unsigned threads, std::function<std::string(std::size_t)> work)
        : threads_(threads), work_(std::move(work)) {}

    std::size_t size() const { return waiting_.size() + running_.size(); }
    // For each thread one more at hand than it works on.
    bool has_room() const { return size() < 2 * threads_; }
    bool empty() const { return size() == 0; }
    void give(std::size_t item) {
        waiting_.push_back(item);
        start();
    }
    // An item that has been done; nothing, after a nap, if there is none. Throws what a worker threw.
    std::optional<DoneItem> take() {
        const auto done = std::find_if(running_.begin(), running_.end(), [](const Running& one) {
            return one.result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
        });
        if (done == running_.end()) {
            if (running_.empty()) {
                nap();
            } else {
                running_.front().result.wait_for(kNap);
            }
            return std::nullopt;
        }
        Running one = std::move(*done);
        running_.erase(done);
        start();
        return DoneItem{one.item, one.result.get()};
    }

  private:
    struct Running {
        std::size_t item;
        std::future<std::string> result;
    };
    void start() {
        try {
            for (; running_.size() < threads_ && !waiting_.empty(); waiting_.pop_front())
                running_.push_back(
                    {waiting_.front(), std::async(std::launch::async, work_, waiting_.front())});
        } catch (const std::system_error&) {
            if (running_.empty()) throw;  // else it waits for a thread that ends
        }
    }

    std::size_t threads_;
    std::function<std::string(std::size_t)> work_;
    std::deque<std::size_t> waiting_;
    std::list<Running> running_;
};

}  // namespace thimble
