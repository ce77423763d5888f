// The verdicts of kernel_path_peer on good and on bad paths.
#include "tests/kernel/path_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <gmock/gmock.h>

#include "common/random.hpp"
#include "netem/link_model.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kPackets = 4000;

// A sample by a link in virtual time, each packet `late` behind.
PathSample sample_of(const LinkSettings& settings, std::uint64_t seed, Duration late = microseconds{30}) {
    LinkModel link(settings, {.study = seed}, 0);
    PathSample sample;
    sample.packets.resize(kPackets);
    std::uint64_t latest = 0;
    const auto take_until = [&](SessionTime now) {
        for (auto out = link.pop_departure(now); !out.bytes.empty(); out = link.pop_departure(now)) {
            std::uint64_t number = 0;
            std::memcpy(&number, out.bytes.data(), sizeof number);
            sample.packets[number] = {true, number < latest, out.due - out.received + late};
            latest = std::max(latest, number);
        }
    };
    for (std::uint64_t number = 0; number < kPackets; ++number) {
        const SessionTime now{milliseconds{number}};
        take_until(now);
        std::array<std::uint8_t, 8> bytes{};
        std::memcpy(bytes.data(), &number, sizeof number);
        link.push(now, bytes);
    }
    while (link.next_due() != kNever) take_until(link.next_due());
    return sample;
}

LinkSettings constant() {
    LinkSettings link;
    link.delay = milliseconds{50};
    return link;
}

LinkSettings normal(double deviation_s = 0.005, bool in_order = false) {
    LinkSettings link = constant();
    link.jitter.shape = JitterShape::kNormal;
    link.jitter.spread = from_seconds(deviation_s);
    link.in_order = in_order;
    return link;
}

std::vector<std::string> judge(const PathRequest& asked, const PathSample& kernel, const PathSample& relay) {
    return disagreements(asked, summarise(kernel), summarise(relay));
}

constexpr PathRequest kConstant{.delay_s = 0.05};
constexpr PathRequest kNormal{.delay_s = 0.05, .normal_s = 0.005};

TEST(PathComparison, TwoLinksAsAskedAgree) {
    EXPECT_THAT(judge(kConstant, sample_of(constant(), 1), sample_of(constant(), 2)), IsEmpty());
    for (std::uint64_t seed = 0; seed < 20; seed += 2) {
        EXPECT_THAT(judge(kNormal, sample_of(normal(), seed), sample_of(normal(), seed + 1)), IsEmpty())
            << seed;
    }
}

TEST(PathComparison, ConstantDelayMayNeitherComeEarlyNorLateNorTwiceNorNever) {
    const PathSample good = sample_of(constant(), 1);
    PathSample early = good, late = good, copied = good, none;
    early.packets[7].delay = milliseconds{50} - Duration{1};
    late.packets[7].delay = milliseconds{50} + microseconds{501};
    copied.copies = 3;
    none.packets.resize(kPackets);
    EXPECT_THAT(judge(kConstant, early, good), ElementsAre(HasSubstr("kernel: delays from 50.0000")));
    EXPECT_THAT(judge(kConstant, good, late), ElementsAre(HasSubstr("thimble-netem: delays from")));
    EXPECT_THAT(judge(kConstant, good, copied), ElementsAre(HasSubstr("thimble-netem: 3 copies")));
    EXPECT_THAT(judge(kConstant, none, none), ElementsAre(HasSubstr("only 0 and 0 packets")));
    EXPECT_THAT(judge(kConstant, {}, {}), ElementsAre(HasSubstr("only 0 and 0 packets")));
}

TEST(PathComparison, AnotherSpreadShapeMeanOrOrderIsSeen) {
    LinkSettings uniform = normal();  // of the same mean and spread
    uniform.jitter.shape = JitterShape::kUniform;
    uniform.jitter.spread = from_seconds(0.005 * std::sqrt(3.0));
    const PathSample good = sample_of(normal(), 1), wide = sample_of(normal(0.0065), 2);
    const struct {
        PathSample kernel, relay;
        const char* breach;
    } cases[]{
        {good, wide, "thimble-netem: standard deviation 6."},
        {wide, good, "distributions: distance"},
        {good, sample_of(uniform, 2), "distributions: distance"},
        {good, sample_of(normal(), 2, milliseconds{1}), "thimble-netem: mean 51."},
        {good, sample_of(normal(0.005, true), 2), "overtaken"},
    };
    for (const auto& one : cases)
        EXPECT_THAT(judge(kNormal, one.kernel, one.relay), testing::Contains(HasSubstr(one.breach)));
}

TEST(PathComparison, LossIsJudgedByTheBinomial) {
    LinkSettings lossy;
    lossy.loss = LossSettings::independent(0.02);
    const PathSample good = sample_of(lossy, 1);
    EXPECT_THAT(judge({.loss = 0.02}, good, sample_of(lossy, 2)), IsEmpty());
    lossy.loss = LossSettings::independent(0.04);
    EXPECT_THAT(judge({.loss = 0.02}, good, sample_of(lossy, 2)),
                testing::Contains(HasSubstr("thimble-netem: 1")));
    EXPECT_THAT(judge({}, good, sample_of({}, 2)), testing::Contains(HasSubstr("kernel: ")));
}

TEST(PathSample, IsReadAsWritten) {
    const TemporaryDirectory folder;
    const std::string file = folder / "sample";
    EXPECT_THROW(read_path_sample(file), Error);
    PathSample sample;
    sample.packets = {{true, false, microseconds{51}}, {}, {true, true, Duration{7}}};
    sample.copies = 1;
    sample.strangers = 2;
    sample.untrusted = 3;
    write_path_sample(sample, file);
    const PathSample read = read_path_sample(file);
    ASSERT_EQ(read.packets.size(), 3U);
    EXPECT_EQ(read.packets[0].delay, microseconds{51});
    EXPECT_FALSE(read.packets[1].arrived);
    EXPECT_TRUE(read.packets[2].overtaken);
    EXPECT_EQ(read.copies + 10 * read.strangers + 100 * read.untrusted, 321U);
    write_text(file, "1,2,3\n7,a\n");
    EXPECT_THROW(read_path_sample(file), Error);
}

}  // namespace
}  // namespace thimble
