// Valid packets, damaged in every way a network or an attacker finds: what still gets in must be good. The
// seeded little sister of fuzz_decode, for every build and every compiler.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common/codec.hpp"
#include "common/random.hpp"
#include "tests/fuzz/packets.hpp"

namespace thimble {
namespace {

constexpr int kCases = 100'000;
using Octets = std::vector<std::uint8_t>;

std::uint8_t& any_byte(Octets& packet, RandomStream& random) {
    return packet[random.below(static_cast<std::uint32_t>(packet.size()))];
}

std::vector<Octets> valid_packets() {
    std::vector<Octets> packets;
    Encoder encoder;
    for (const Message& message : sample_messages()) {
        const Bytes bytes = encoder.encode(message);
        packets.emplace_back(bytes.begin(), bytes.end());
    }
    return packets;
}

// Aligned, since that is where numbers are.
void set_number(Octets& packet, RandomStream& random) {
    using Limits = std::numeric_limits<double>;
    constexpr std::array kNumbers{Limits::quiet_NaN(),
                                  Limits::infinity(),
                                  -Limits::infinity(),
                                  Limits::max(),
                                  Limits::denorm_min(),
                                  -0.0,
                                  -1e-9,
                                  9.99,
                                  -10.01,
                                  1e4,
                                  1.01e6};
    if (packet.size() < 8) return;
    const auto bits = std::bit_cast<std::array<std::uint8_t, 8>>(kNumbers[random.below(kNumbers.size())]);
    const std::size_t at =
        packet.size() % 8 + std::size_t{8} * random.below(static_cast<std::uint32_t>(packet.size() / 8));
    std::copy(bits.begin(), bits.end(), packet.begin() + static_cast<std::ptrdiff_t>(at));
}

// One to three wounds, small ones most often: a packet that is damaged too much is refused at the first look.
void damage(Octets& packet, RandomStream& random) {
    constexpr std::array<std::uint8_t, 6> kBytes{0x00, 0x01, 0x04, 0x7f, 0x80, 0xff};
    for (std::uint32_t n = 1 + random.below(3); n > 0; --n) {
        const std::uint32_t wound = random.below(16);
        if (wound == 0) packet.resize(1 + random.below(static_cast<std::uint32_t>(packet.size())));
        if (wound == 1) {
            for (std::uint32_t more = 1 + random.below(500); more > 0; --more)
                packet.push_back(static_cast<std::uint8_t>(random()));
        }
        if (wound >= 2 && wound <= 4) any_byte(packet, random) = kBytes[random.below(kBytes.size())];
        if (wound >= 5 && wound <= 8) set_number(packet, random);
        if (wound > 8) any_byte(packet, random) ^= static_cast<std::uint8_t>(1U << random.below(8));
    }
}

// In a heap block of exactly its size, so that AddressSanitizer sees a read past its end.
Decoded decode_exact(const Octets& packet) {
    const auto block = std::make_unique<std::uint8_t[]>(packet.size());
    std::copy(packet.begin(), packet.end(), block.get());
    return decode({block.get(), packet.size()});
}

TEST(HostileBytes, SamplesAreGoodAndFieldsAreCompared) {
    std::vector<Message> samples = sample_messages();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        EXPECT_EQ(flaw_of(samples[i]), nullptr) << i;
    }
    Message changed = samples[0];
    std::get<NeedleCommand>(changed.body).force_hand_N += 1;
    EXPECT_NE(samples[0], changed);
    std::get<NeedleCommand>(changed.body).force_hand_N = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(plausible(changed));
}

TEST(HostileBytes, NothingImplausibleGetsIn) {
    const std::vector<Octets> packets = valid_packets();
    RandomStream random(StreamKey{.study = 20, .purpose = Purpose::kLinkLoss});
    std::array<int, static_cast<std::size_t>(Refusal::kCount)> refused{};
    int accepted = 0;
    for (int i = 0; i < kCases; ++i) {
        Octets packet = packets[random.below(static_cast<std::uint32_t>(packets.size()))];
        damage(packet, random);
        const Decoded decoded = decode_exact(packet);
        if (decoded.message) {
            ++accepted;
            ASSERT_EQ(flaw_of(*decoded.message), nullptr) << "case " << i;
        } else {
            ASSERT_TRUE(decoded.refusal) << "case " << i;
            ++refused[static_cast<std::size_t>(*decoded.refusal)];
        }
    }
    // The cases are worth something only if they get to every gate and through.
    EXPECT_GT(accepted, kCases / 10);
    for (const Refusal refusal :
         {Refusal::kTooShort, Refusal::kTooLong, Refusal::kForeignFormat, Refusal::kMalformed,
          Refusal::kNotOneBody, Refusal::kNotFinite, Refusal::kOutOfRange}) {
        EXPECT_GT(refused[static_cast<std::size_t>(refusal)], 10) << to_string(refusal);
    }
}

TEST(HostileBytes, NoiseIsRefused) {
    RandomStream random(StreamKey{.study = 21, .purpose = Purpose::kLinkLoss});
    for (int i = 0; i < kCases / 10; ++i) {
        Octets packet(random.below(kMaxDatagramBytes + 2));
        std::generate(packet.begin(), packet.end(), [&] { return static_cast<std::uint8_t>(random()); });
        EXPECT_FALSE(decode_exact(packet).message.has_value()) << "case " << i;
    }
}

}  // namespace
}  // namespace thimble
