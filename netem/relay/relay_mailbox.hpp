// How another thread asks the relaying one for something: it leaves a task, and the relaying thread carries it out in its
// next round. A lock would let a sleeper hold up the relaying thread.
#pragma once

#include <atomic>
#include <functional>
#include <future>

#include "common/error.hpp"
#include "netem/relay/steered_relay.hpp"

namespace thimble {

// For one asking thread.
class RelayMailbox {
  public:
    using Job = std::function<RelayState(SteeredRelay& relay)>;

    // Waits for the answer. Throws Error (run failed) if the relay does not come to it, and what the job throws.
    RelayState ask(const Job& job) {
        Task task(job);
        std::future<RelayState> result = task.get_future();
        waiting_ = &task;
        if (result.wait_for(kRelayPatience) == std::future_status::timeout &&
            waiting_.exchange(nullptr) != nullptr) {
            throw Error(ExitCode::kRunFailed, "the relay is too busy to answer, or ending");
        }
        return result.get();  // a task that was taken ends
    }

    // For the relaying thread, in each of its rounds. Never waits.
    void serve(SteeredRelay& relay) {
        if (waiting_.load(std::memory_order_relaxed) == nullptr) return;
        Task* const waiting = waiting_.exchange(nullptr);
        if (waiting == nullptr) return;
        Task task = std::move(*waiting);  // gone once it has been answered
        task(relay);
    }

  private:
    using Task = std::packaged_task<RelayState(SteeredRelay& relay)>;
    static constexpr std::chrono::seconds kRelayPatience{2};

    std::atomic<Task*> waiting_{nullptr};
};

}  // namespace thimble
