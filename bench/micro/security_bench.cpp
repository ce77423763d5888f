// The cost of protection per datagram.
//   build/release/bin/thimble-bench --benchmark_filter=security
#include <array>
#include <vector>

#include <benchmark/benchmark.h>

#include "common/security/handshake.hpp"

namespace {

using namespace thimble;

SecretKey bench_key() {
    SecretKey key;
    key.bytes.fill(3);
    return key;
}

// 104 bytes: a NeedleCommand; 144: a ForceFeedback. On a hop they are 32 bytes longer.
void seal(benchmark::State& state, PacketKind kind) {
    Sealer sealer;
    sealer.arm(bench_key());
    const std::vector<std::uint8_t> text(static_cast<std::size_t>(state.range(0)), 1);
    for (auto _ : state) benchmark::DoNotOptimize(sealer.seal(kind, Port::kSlaveNeedle, text).data());
}
BENCHMARK_CAPTURE(seal, security, PacketKind::kData)->Arg(104)->Arg(144);
BENCHMARK_CAPTURE(seal, security_hop, PacketKind::kHop)->Arg(136)->Arg(176);

// Sealed beforehand: each opens once.
void open(benchmark::State& state, PacketKind kind) {
    constexpr std::size_t kSealedAtOnce = 1000;
    Sealer sealer;
    sealer.arm(bench_key());
    const std::vector<std::uint8_t> text(static_cast<std::size_t>(state.range(0)), 1);
    Opener opener;
    opener.arm(bench_key());
    std::vector<std::vector<std::uint8_t>> sealed(kSealedAtOnce);
    std::array<std::uint8_t, kMaxDatagramBytes> out{};
    SecurityCounters counters;
    std::size_t next = kSealedAtOnce;
    for (auto _ : state) {
        if (next == kSealedAtOnce) {
            state.PauseTiming();
            for (auto& one : sealed) {
                const Bytes bytes = sealer.seal(kind, Port::kSlaveNeedle, text);
                one.assign(bytes.begin(), bytes.end());
            }
            next = 0;
            state.ResumeTiming();
        }
        const auto& datagram = sealed[next++];
        benchmark::DoNotOptimize(opener.open(*read_seal_header(datagram), datagram, out, counters));
    }
}
BENCHMARK_CAPTURE(open, security, PacketKind::kData)->Arg(104)->Arg(144);
BENCHMARK_CAPTURE(open, security_hop, PacketKind::kHop)->Arg(136)->Arg(176);

void security_refuse_forged(benchmark::State& state) {
    Sealer sealer;
    sealer.arm(bench_key());
    Opener opener;
    opener.arm(bench_key());
    const Bytes sealed =
        sealer.seal(PacketKind::kData, Port::kSlaveNeedle, std::vector<std::uint8_t>(144, 1));
    std::vector<std::uint8_t> forged(sealed.begin(), sealed.end());
    forged.back() ^= 1;
    std::array<std::uint8_t, kMaxDatagramBytes> out{};
    SecurityCounters counters;
    for (auto _ : state)
        benchmark::DoNotOptimize(opener.open(*read_seal_header(forged), forged, out, counters));
}
BENCHMARK(security_refuse_forged);

void security_refuse_hello(benchmark::State& state) {
    prepare_security();
    std::array<std::uint8_t, kKeyBytes> bytes{};
    const LabKey lab(bytes);
    HandshakeBytes hello = write_handshake(lab, {PacketKind::kHello, Port::kSessionMaster, {}, {}});
    hello[40] ^= 1;
    for (auto _ : state) benchmark::DoNotOptimize(read_handshake(lab, Port::kSessionMaster, hello));
}
BENCHMARK(security_refuse_hello);

// One side's share: a one-time key, and the keys that both compute.
void security_handshake(benchmark::State& state) {
    prepare_security();
    std::array<std::uint8_t, kKeyBytes> bytes{};
    const LabKey lab(bytes);
    const RandomBytes random = system_random_bytes();
    const PublicKey peer = make_one_time_key(random).open;
    for (auto _ : state) {
        const OneTimeKey own = make_one_time_key(random);
        benchmark::DoNotOptimize(
            agree(lab, {Port::kMasterControl, Port::kSessionMaster, own.open, peer}, own.secret, peer));
    }
}
BENCHMARK(security_handshake);

}  // namespace
