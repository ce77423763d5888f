// The cost of logging its messages to a loop.
//   build/release/bin/thimble-bench --benchmark_filter=log
#include <benchmark/benchmark.h>

#include "common/codec.hpp"
#include "common/queue_channel.hpp"
#include "common/runtime/log/tapped_channel.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kLogQueueBytes = std::size_t{4} << 20;

// Between two drainings, which are another thread's and not measured here.
constexpr std::uint64_t kBatch = 8192;

void empty_now_and_then(benchmark::State& state, ByteQueue& queue, std::uint64_t& pushed) {
    if (++pushed % kBatch != 0) return;
    state.PauseTiming();
    queue.drain([](const ByteQueue::Entry&, Bytes) {});
    state.ResumeTiming();
}

// The copy alone.
void log_push(benchmark::State& state) {
    ByteQueue queue(kLogQueueBytes);
    Encoder encoder;
    const Bytes message = encoder.encode(Header{}, ForceFeedback{});
    std::uint64_t pushed = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(queue.push(0, 0, message));
        empty_now_and_then(state, queue, pushed);
    }
    state.SetLabel(std::to_string(message.size()) + " bytes");
    if (queue.lost() > 0) state.SkipWithError("the queue was full");
}
BENCHMARK(log_push);

// As a node pays it: the virtual call, the clock, the copy. `tapped` 0: the same without a log.
void log_send(benchmark::State& state) {
    ByteQueue queue(kLogQueueBytes);
    QueueChannel nowhere;
    TappedChannel tapped(nowhere, queue, 0, 1);
    Channel* channel = state.range(0) != 0 ? static_cast<Channel*>(&tapped) : &nowhere;
    benchmark::DoNotOptimize(channel);
    Encoder encoder;
    const Bytes message = encoder.encode(Header{}, ForceFeedback{});
    std::uint64_t pushed = 0;
    for (auto _ : state) {
        channel->send(message);
        empty_now_and_then(state, queue, pushed);
    }
    if (queue.lost() > 0) state.SkipWithError("the queue was full");
}
BENCHMARK(log_send)->ArgName("tapped")->Arg(0)->Arg(1);

}  // namespace
