// The same bits from every compiler and build type: checksums over all that solvers and scenes give, which
// stand here. g++ and clang++, release, debug and sanitizers must each find them, on every CPU (tests/same-bits).
#include <array>
#include <bit>
#include <cstdint>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {
namespace {

// FNV-1a (Fowler, Noll and Vo), 64 bits.
class Checksum {
  public:
    void add(double value) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        for (int shift = 0; shift < 64; shift += 8) add_byte(bits >> shift & 0xff);
    }
    void add(std::string_view text) {
        for (const char c : text) add_byte(static_cast<unsigned char>(c));
    }
    void add(const Transitions& transitions) {
        for (const Transition& t : transitions) {
            add(t.offset_s);
            add(t.phase);
        }
    }
    std::uint64_t value() const { return value_; }

  private:
    void add_byte(std::uint64_t byte) { value_ = (value_ ^ byte) * 0x100000001b3; }

    std::uint64_t value_ = 0xcbf29ce484222325;
};

// A needle of whole micrometres and steps of whole microseconds, by Knuth's linear congruential generator:
// strokes, holds and tremor, without any function of libm.
class IntegerNeedle {
  public:
    struct Sample {
        double duration_s;
        double position_m;
    };
    Sample next() {
        const std::uint64_t kind = draw(10);
        if (kind < 5) at_um_ += static_cast<std::int64_t>(draw(4001)) - 2000;
        if (kind == 5) at_um_ += static_cast<std::int64_t>(draw(3)) - 1;
        if (kind >= 8) at_um_ = static_cast<std::int64_t>(draw(120'000));
        const std::uint64_t duration_us = kind == 9 ? draw(500'000) + 1 : draw(20'000) + 1;
        return {static_cast<double>(duration_us) * 1e-6, static_cast<double>(at_um_) * 1e-6};
    }

  private:
    std::uint64_t draw(std::uint64_t below) {
        state_ = state_ * 6364136223846793005U + 1442695040888963407U;
        return (state_ >> 33) % below;
    }

    std::uint64_t state_ = 2026;
    std::int64_t at_um_ = 0;
};

// The paper's tissue, critically damped and 1e-12 to either side of it, ringing, undamped, without a spring;
// and, for those that take them, massless, heavy and as stiff as a wall.
const std::vector<TissueParameters> kSoft{
    {1, 2, 5, 0.7, 0.1, 0.02},
    {1, 9, 5.5, 0.5, 0.1, 0.02},
    {1, 9.000000000009, 5.5, 0.5, 0.1, 0.02},
    {1, 8.999999999991, 5.5, 0.5, 0.1, 0.02},
    {0.05, 200, 0.3, 0.1, 0.5, 0.03},
    {0.5, 50, 0, 0, 0.2, 0.01},
    {2, 0, 3, 0.2, 0.05, 0.04},
};
const std::vector<TissueParameters> kHard{
    {1e-12, 2, 5, 0.7, 0.1, 0.02}, {1e6, 2, 5, 0.7, 0.1, 0.02}, {0.05, 1e6, 20, 2, 200, 0.02}};

std::uint64_t bits_of(std::string_view solver, const std::vector<TissueParameters>& tissues) {
    Checksum sum;
    for (const TissueParameters& p : tissues) {
        const auto tissue = solver_maker({solver, 1e-3})(p);
        IntegerNeedle needle;
        Transitions events(Transitions::kUnlimited);
        tissue->reset(0);
        for (int i = 0; i < 2000; ++i) {
            const IntegerNeedle::Sample sample = needle.next();
            events.clear();
            tissue->advance(sample.duration_s, sample.position_m, events);
            const TissueState s = tissue->state();
            sum.add(to_string(s.phase));
            for (const double value : {s.position_surface_m, s.velocity_surface_m_per_s, s.force_N})
                sum.add(value);
            sum.add(events);
        }
    }
    return sum.value();
}

TEST(SameBits, OfExact) {
    EXPECT_EQ(bits_of("exact", kSoft), 0x3fa60ac16b4561bbU);
    EXPECT_EQ(bits_of("exact", kHard), 0xfd3c859873c5f293U);
}

TEST(SameBits, OfSteppedSolvers) {
    EXPECT_EQ(bits_of("semi_implicit_euler", kSoft), 0x75f8a985e3000386U);
    EXPECT_EQ(bits_of("rk4", kSoft), 0x93b6cdd4559ceae3U);
    EXPECT_EQ(bits_of("implicit_midpoint", kSoft), 0x5520f75050e77754U);
    EXPECT_EQ(bits_of("implicit_midpoint", kHard), 0xce4c46303982bb2cU);
}

TEST(SameBits, OfScenes) {
    Checksum sum;
    for (const char* name :
         {"paper.toml", "experiment2.toml", "layers.toml", "vessel.toml", "guidance.toml"}) {
        NeedleScene scene(load_scene(name), solver_maker({}), Transitions::kUnlimited);
        IntegerNeedle needle;
        double now_s = 0;
        for (int i = 0; i < 2000; ++i) {
            const IntegerNeedle::Sample sample = needle.next();
            scene.clear_transitions();
            scene.step(now_s, sample.duration_s, {sample.position_m, sample.position_m});
            now_s += sample.duration_s;
            sum.add(scene.force_tissue_N());
            sum.add(scene.force_fixture_N());
            sum.add(scene.transitions());
        }
    }
    EXPECT_EQ(sum.value(), 0xb146e0d4284114f8U);
}

}  // namespace
}  // namespace thimble
