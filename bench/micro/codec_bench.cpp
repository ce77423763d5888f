// Bytes out and in, per message.
//   build/release/bin/thimble-bench --benchmark_filter=codec
#include <benchmark/benchmark.h>

#include "common/codec.hpp"
#include "common/flow.hpp"

namespace {

using namespace thimble;

template <class Message>
void codec_encode(benchmark::State& state) {
    Encoder encoder;
    Header header;
    const Message body;
    for (auto _ : state) {
        ++header.sequence;
        benchmark::DoNotOptimize(encoder.encode(header, body).data());
    }
    state.SetLabel(std::to_string(encoder.encode(header, body).size()) + " bytes");
}
BENCHMARK(codec_encode<NeedleCommand>);
BENCHMARK(codec_encode<ForceFeedback>);

// Verified, range- and finiteness-checked.
template <class Body>
void codec_decode(benchmark::State& state) {
    Encoder encoder;
    Header header;
    const Bytes bytes = encoder.encode(header, Body{});
    Message message;
    for (auto _ : state) benchmark::DoNotOptimize(decode_into(bytes, message));
}
BENCHMARK(codec_decode<NeedleCommand>);
BENCHMARK(codec_decode<ForceFeedback>);

// Decode plus sequence, instance, stamp and role checks.
void codec_admit(benchmark::State& state) {
    Encoder encoder;
    InboundFlow flow(Role::kSlaveSim);
    Header header;
    header.sender = Role::kSlaveSim;
    for (auto _ : state) {
        ++header.sequence;
        benchmark::DoNotOptimize(flow.admit(SessionTime{}, encoder.encode(header, ForceFeedback{})));
    }
}
BENCHMARK(codec_admit);

}  // namespace
