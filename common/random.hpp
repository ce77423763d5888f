// Counter-based random numbers: a stream is a key and a counter. So subject 7 draws the same numbers alone, in a
// batch, after a resume, or after a trial was added. Philox 4x32-10 (Salmon, Moraes, Dror and Shaw, "Parallel random
// numbers: as easy as 1, 2, 3", SC11).
#pragma once

#include <array>
#include <cstdint>

namespace thimble {

// The purpose of a stream. Append only: the numbers are part of every published seed.
enum class Purpose : std::uint32_t {
    kSubject = 1,
    kOrder = 2,
    kFixture = 3,
    kReaction = 4,
    kSpeed = 5,
    kPositionNoise = 6,
    kTremor = 7,
    kForceNoise = 8,
    kPerception = 9,
    kFrames = 10,
    kLinkDelay = 11,
    kLinkLoss = 12,
    kInstance = 13,
    kSpeedNoise = 14,
    kParameter = 15,
    kLinkChain = 16,  // moves of a loss chain
    kLinkDuplicate = 17,
    kLinkDuplicateDelay = 18,
    kLinkCorrupt = 19,
    kLinkCorruptBits = 20,
    kLinkReorder = 21,
    kLinkSlot = 22,
    kPreviousModality = 23,
};

struct StreamKey {
    std::uint64_t study = 0;
    std::uint32_t experiment = 0;
    std::uint32_t subject = 0;
    std::uint32_t trial = 0;
    Purpose purpose = Purpose::kSubject;
};

// One block of the generator: a pure function of key and counter.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

class RandomStream {
  public:
    using result_type = std::uint64_t;

    explicit RandomStream(const StreamKey& key);

    // Jumps to the n-th 64-bit number of the stream (for fates keyed by packet number).
    void seek(std::uint64_t n);

    std::uint64_t operator()() {
        if (next_ == 2) refill();
        return block_[next_++];
    }
    static constexpr std::uint64_t min() { return 0; }
    static constexpr std::uint64_t max() { return ~std::uint64_t{0}; }

    double uniform();  // in [0, 1), 53 bits
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    double normal();  // standard normal
    // Uniform in [0, n), n > 0, without modulo bias.
    std::uint32_t below(std::uint32_t n);

  private:
    void refill();

    std::array<std::uint32_t, 2> key_{};
    std::array<std::uint32_t, 2> stream_{};
    std::uint64_t counter_ = 0;
    std::array<std::uint64_t, 2> block_{};
    unsigned next_ = 2;
};

}  // namespace thimble
