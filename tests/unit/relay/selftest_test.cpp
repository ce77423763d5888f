#include "netem/relay/selftest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "netem/delivery_trace.hpp"
#include "netem/packet_trace.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

TwinLink jittery() {
    TwinLink link;
    link.settings.delay = milliseconds{50};
    link.settings.jitter = {JitterShape::kNormal, milliseconds{5}};
    link.settings.loss = LossSettings::independent(0.05);
    link.key.study = 3;
    link.direction = 11;
    return link;
}

std::vector<SessionTime> kilohertz(int packets) {
    std::vector<SessionTime> times;
    for (int i = 0; i < packets; ++i) times.emplace_back(milliseconds{i});
    return times;
}

TEST(KsDistance, IsTheLargestGapOfTheSteps) {
    std::vector<double> a{1, 2, 3, 4}, b{3, 4, 5, 6}, same{4, 2, 1, 3}, none;
    EXPECT_DOUBLE_EQ(ks_distance(a, b), 0.5);
    EXPECT_DOUBLE_EQ(ks_distance(a, same), 0);
    std::vector<double> ties{2, 2, 2, 2};
    EXPECT_DOUBLE_EQ(ks_distance(a, ties), 0.5);
    EXPECT_DOUBLE_EQ(ks_distance(a, none), 1);
}

TEST(Twin, ForetellsTheSameSeed) {
    const auto times = kilohertz(2000);
    const TwinOutcome once = replay(jittery(), times, 104), again = replay(jittery(), times, 104);
    EXPECT_EQ(once.dropped_packet, again.dropped_packet);
    EXPECT_EQ(once.delays_s, again.delays_s);
    EXPECT_EQ(once.delays_s.size() + once.dropped, times.size());
    TwinLink other = jittery();
    other.key.study = 4;
    EXPECT_NE(replay(other, times, 104).dropped_packet, once.dropped_packet);
}

TEST(Twin, FollowsATransmitterToItsEnd) {
    TwinLink link = jittery();
    link.settings.rate.bits_per_s = 100'000;
    link.settings.rate.queue_packets = 5;
    const TwinOutcome outcome = replay(link, kilohertz(1000), 104);
    EXPECT_GT(outcome.dropped, 500U);
    EXPECT_EQ(outcome.delays_s.size() + outcome.dropped, 1000U);
}

TEST(Comparison, FindsAnHonestLinkInnocent) {
    const auto times = kilohertz(4000);
    const Comparison c = compare(jittery(), times, 104, replay(jittery(), times, 104).delays_s);
    EXPECT_TRUE(c.spread);
    EXPECT_LT(c.distance_ratio(), 1.5);
    EXPECT_NEAR(c.dropped_mean, 200, 15);  // 5 %
}

TEST(Comparison, FindsADistortedDelay) {
    const auto times = kilohertz(4000);
    std::vector<double> delays_s = replay(jittery(), times, 104).delays_s;
    for (double& d : delays_s) d += 0.003;
    EXPECT_GT(compare(jittery(), times, 104, delays_s).distance_ratio(), 3);
}

TEST(Comparison, KnowsAConstantDelay) {
    TwinLink link = jittery();
    link.settings.jitter = {};
    link.settings.loss = {};
    const Comparison c = compare(link, kilohertz(500), 104, std::vector<double>(500, 0.05004));
    EXPECT_FALSE(c.spread);
    EXPECT_EQ(c.dropped_mean, 0);
}

// A second copy that finds no room is no packet that was dropped: the first is on its way.
TEST(Twin, TellsCopiesFromPackets) {
    TwinLink link;
    link.settings.duplicate = 1;
    link.settings.rate.bits_per_s = 104 * 8 * 1000;
    link.settings.rate.queue_packets = 1;
    const TwinOutcome outcome = replay(link, kilohertz(10), 104);
    EXPECT_EQ(outcome.dropped, 0U);
    EXPECT_EQ(outcome.delays_s.size(), 10U);
}

TEST(SelftestDrain, IsAsLongAsPacketsCanBeOnTheirWay) {
    SelftestSettings settings;
    const Duration settling = selftest_drain(settings, 0);
    settings.links.up.delay = milliseconds{20};
    settings.timelines.up = {{std::chrono::seconds{3}, {.delay = milliseconds{500}}},
                             {std::chrono::hours{1}, {.delay = std::chrono::seconds{9}}}};
    EXPECT_EQ(selftest_drain(settings, 0), settling + milliseconds{500});
    // One packet in 4 ms: of 8,000 in 8 s the link still holds as many as fit.
    settings.links.up.rate.bits_per_s = 132 * 8 * 250;
    EXPECT_EQ(selftest_drain(settings, 28), settling + milliseconds{20 + 4 * 4096});
    settings.length = std::chrono::milliseconds{1250};
    settings.timelines = {};
    EXPECT_EQ(selftest_drain(settings, 28), settling + milliseconds{20 + 3 * 1000});
    settings.links.up.rate.queue_packets = 10;
    EXPECT_EQ(selftest_drain(settings, 28), settling + milliseconds{20 + 4 * 11});
    // The same rate from a trace, and a recording with a gap of 6 s.
    const Duration of_rate = selftest_drain(settings, 28);
    const RateSettings queue{.queue_packets = 10};
    settings.links.up.rate = queue;
    settings.links.up.trace = std::make_shared<PacketTrace>(
        std::vector<TraceRow>{{.bits_per_s = 1e9}, {.at = 1, .bits_per_s = 132 * 8 * 250}},
        TraceLayout{.has_delay = false, .has_rate = true});
    EXPECT_EQ(selftest_drain(settings, 28), of_rate);
    settings.links.up.trace = nullptr;
    settings.links.up.deliveries = std::make_shared<DeliveryTrace>(std::vector<std::uint32_t>{6, 12, 6000});
    EXPECT_GT(selftest_drain(settings, 28), std::chrono::seconds{6});
    settings.links.up.deliveries = nullptr;
    settings.links.up.rate = {.bits_per_s = 1};
    EXPECT_THAT(refusal([&] { selftest_drain(settings, 28); }, ExitCode::kUsage), HasSubstr("higher rate"));
}

SelftestResult good() {
    SelftestResult result;
    for (std::size_t d = 0; d < 2; ++d) {
        SelftestDirection& direction = result.direction[d];
        direction.offered = direction.received = direction.arrived = 8000;
        direction.comparison = {true, 0.01, 0.012, 0};
        for (int i = 0; i < 8000; ++i)
            result.state.totals.direction[d].error.add(microseconds{i < 7990 ? 20 : 40});
    }
    for (int i = 0; i < 2000; ++i) result.timer.add(microseconds{30});
    judge(result);
    return result;
}

TEST(SelftestVerdict, PassesWhatIsGood) {
    const SelftestResult result = good();
    EXPECT_EQ(result.verdict, SelftestVerdict::kPass);
    EXPECT_THAT(result.causes, IsEmpty());
    EXPECT_EQ(describe(result).at("verdict"), "PASS");
    EXPECT_THAT(selftest_text(result), HasSubstr("PASS"));
}

void add_late(SelftestResult& result, int packets) {
    for (int i = 0; i < packets; ++i) result.state.totals.direction[0].error.add(milliseconds{3});
}

TEST(SelftestVerdict, NamesFaults) {
    struct Fault {
        void (*make)(SelftestResult&);
        SelftestVerdict verdict;
        const char* cause;
    };
    using Result = SelftestResult;
    constexpr auto kMarginal = SelftestVerdict::kMarginal, kFail = SelftestVerdict::kFail;
    for (const Fault& fault :
         {Fault{[](Result& r) { r.direction[0].early = 1; }, kFail, "before they were due"},
          Fault{[](Result& r) { r.direction[1].other_fates = 1; }, kFail, "not have the fate of their seed"},
          Fault{[](Result& r) { r.direction[0].lost_by_machine = 1; }, kMarginal, "machine lost 1"},
          Fault{[](Result& r) { r.direction[0].lost_by_machine = 9; }, kFail, "machine lost 9"},
          Fault{[](Result& r) { add_late(r, 100); }, kFail, "bare timer"},
          Fault{[](Result& r) { add_late(r, 20); }, kMarginal, "stalls"},
          Fault{[](Result& r) { r.direction[0].comparison.distance = 0.025; }, kMarginal,
                "not follow the requested distribution"},
          Fault{[](Result& r) { r.direction[0].comparison.distance = 0.2; }, kFail,
                "not follow the requested distribution"},
          Fault{[](Result& r) { r.direction[0].lost_chance = 0; }, kFail, "of all seeds differ so much"},
          Fault{[](Result& r) { r.direction[0].lost_chance = 5e-5; }, kMarginal,
                "of all seeds differ so much"},
          Fault{[](Result& r) { r.direction[0].received = 100; }, kMarginal, "too few"}}) {
        SelftestResult result = good();
        fault.make(result);
        judge(result);
        EXPECT_EQ(result.verdict, fault.verdict) << fault.cause;
        EXPECT_THAT(result.causes, Contains(HasSubstr(fault.cause)));
    }
}

}  // namespace
}  // namespace thimble
