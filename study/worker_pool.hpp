// One pool for all that is many trials: threads of this program, or the ranks of an MPI job with threads each. Results come in the order
// of the items, so that nothing depends on the number of workers.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "study/ordered_workers.hpp"
#include "study/ranks/ranks.hpp"

namespace thimble {

// A result between ranks, which are the same program: text, a plain struct, or a list of these.
template <class Result>
void append_bytes(std::string& bytes, const Result& result) {
    static_assert(std::is_trivially_copyable_v<Result>);
    bytes.append(reinterpret_cast<const char*>(&result), sizeof result);
}
template <class Element>
void append_bytes(std::string& bytes, const std::vector<Element>& list) {
    for (const Element& element : list) append_bytes(bytes, element);
}
inline void append_bytes(std::string& bytes, const std::string& text) { bytes += text; }

template <class Result>
void read_bytes(std::string_view bytes, Result& result) {
    std::memcpy(static_cast<void*>(&result), bytes.data(), std::min(bytes.size(), sizeof result));
}
template <class Element>
void read_bytes(std::string_view bytes, std::vector<Element>& list) {
    list.resize(bytes.size() / sizeof(Element));
    for (std::size_t i = 0; i < list.size(); ++i)
        read_bytes(bytes.substr(i * sizeof(Element), sizeof(Element)), list[i]);
}
inline void read_bytes(std::string_view bytes, std::string& text) { text = bytes; }

// All workers together. `jobs` are threads of each rank, 0: one. Without ranks they are threads of this program, 0: one per core.
inline std::size_t worker_count(unsigned jobs) {
    if (const Ranks* const ranks = joined_ranks()) return ranks->count() * std::max(1U, jobs);
    return thread_count(jobs);
}

// work(i) gives the result of item i < count; several threads call it. take(result) gets them in order, in the thread
// that called this. Under mpirun each rank calls it. plan() must give the same text there (ranks.hpp). False if `stop`
// (null: never) came before the last item. Throws what a worker threw.
template <class Result, class Work, class Take>
bool run_in_order(std::size_t count, unsigned jobs, const std::atomic<bool>* stop, const Work& work,
                  const Take& take, ResultsGo results = ResultsGo::kToAll,
                  const std::function<std::string()>& plan = {}) {
    if (Ranks* const ranks = joined_ranks()) {
        const auto work_bytes = [&](std::size_t i) {
            std::string bytes;
            append_bytes(bytes, work(i));
            return bytes;
        };
        const auto take_bytes = [&](const std::string& bytes) {
            Result result{};
            read_bytes(bytes, result);
            take(std::move(result));
        };
        return ranks->run({count, std::max(1U, jobs), work_bytes, take_bytes, stop, results,
                           plan ? plan() : std::string()});
    }
    OrderedWorkers<Result> workers(count, thread_count(jobs), work, stop);
    for (std::size_t i = 0; i < count; ++i) {
        std::optional<Result> result = workers.take();
        if (!result) return false;
        take(std::move(*result));
    }
    return true;
}

}  // namespace thimble
