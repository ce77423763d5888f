#include "common/random.hpp"

#include <cassert>

#include <boost/random/normal_distribution.hpp>

#include "common/math/real.hpp"

namespace thimble {
namespace {

constexpr std::uint32_t kMultiplier0 = 0xD2511F53U, kMultiplier1 = 0xCD9E8D57U;
constexpr std::uint32_t kWeyl0 = 0x9E3779B9U, kWeyl1 = 0xBB67AE85U;
constexpr int kRounds = 10;

// Mixes 64 bits so that neighbouring subjects and trials get unrelated keys (splitmix64's finaliser, Steele,
// Lea and Flood 2014).
std::uint64_t mix(std::uint64_t x) {
    x += 0x9E3779B97F4A7C15ULL;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
    return x ^ (x >> 31);
}

constexpr std::uint64_t join(std::uint32_t high, std::uint32_t low) {
    return (std::uint64_t{high} << 32) | low;
}

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> c, std::array<std::uint32_t, 2> k) {
    for (int round = 0; round < kRounds; ++round) {
        const std::uint64_t p0 = std::uint64_t{kMultiplier0} * c[0];
        const std::uint64_t p1 = std::uint64_t{kMultiplier1} * c[2];
        c = {static_cast<std::uint32_t>(p1 >> 32) ^ c[1] ^ k[0], static_cast<std::uint32_t>(p1),
             static_cast<std::uint32_t>(p0 >> 32) ^ c[3] ^ k[1], static_cast<std::uint32_t>(p0)};
        k = {k[0] + kWeyl0, k[1] + kWeyl1};
    }
    return c;
}

RandomStream::RandomStream(const StreamKey& key) {
    const std::uint64_t who = mix(mix(mix(key.study) ^ join(key.experiment, key.subject)) ^
                                  join(key.trial, static_cast<std::uint32_t>(key.purpose)));
    const std::uint64_t stream = mix(who);
    key_ = {static_cast<std::uint32_t>(who), static_cast<std::uint32_t>(who >> 32)};
    stream_ = {static_cast<std::uint32_t>(stream), static_cast<std::uint32_t>(stream >> 32)};
}

void RandomStream::refill() {
    const auto words = philox({static_cast<std::uint32_t>(counter_),
                               static_cast<std::uint32_t>(counter_ >> 32), stream_[0], stream_[1]},
                              key_);
    block_ = {join(words[1], words[0]), join(words[3], words[2])};
    ++counter_;
    next_ = 0;
}

void RandomStream::seek(std::uint64_t n) {
    counter_ = n / 2;
    refill();
    next_ = static_cast<unsigned>(n % 2);
}

double RandomStream::uniform() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }

double RandomStream::normal() {
    boost::random::normal_distribution<portable::Real> distribution;  // a ziggurat without state
    return static_cast<double>(distribution(*this));
}

std::uint32_t RandomStream::below(std::uint32_t n) {
    assert(n > 0);
    const std::uint64_t limit = max() - max() % n;
    std::uint64_t x = (*this)();
    while (x >= limit) x = (*this)();
    return static_cast<std::uint32_t>(x % n);
}

}  // namespace thimble
