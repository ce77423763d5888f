// tc-netem's words: each of them, what is refused and why, and back again.
#include "netem/formats/tc_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/error.hpp"
#include "netem/jitter_table.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

LinkSettings parsed_words(std::string_view words) { return parse_tc(words).up; }

std::string tc_refusal_of(std::string_view words) {
    return refusal([&] { parse_tc(words); }, ExitCode::kUsage);
}

TEST(TcWords, DelayHasTheUnitsOfTc) {
    for (const auto& [words, delay] :
         std::vector<std::pair<std::string, Duration>>{{"delay 50ms", milliseconds{50}},
                                                       {"latency 50msec", milliseconds{50}},
                                                       {"delay 0.05s", milliseconds{50}},
                                                       {"delay 1sec", seconds{1}},
                                                       {"delay 1.5MS", microseconds{1500}},
                                                       {"delay 800us", microseconds{800}},
                                                       {"delay 800", microseconds{800}},
                                                       {"delay 5e2us", microseconds{500}},
                                                       {"delay 0.1ms", microseconds{100}}}) {
        EXPECT_EQ(parsed_words(words).delay, delay) << words;
        EXPECT_EQ(parsed_words(words).jitter.shape, JitterShape::kNone) << words;
    }
}

TEST(TcWords, JitterIsUniformWithoutADistribution) {
    const LinkSettings link = parsed_words("delay 50ms 10ms 25%");
    EXPECT_EQ(link.jitter.shape, JitterShape::kUniform);
    EXPECT_EQ(link.jitter.spread, milliseconds{10});
    EXPECT_EQ(link.jitter.correlation, 0.25);
}

// The kernel queues by the time of leaving; with a rate it counts from the packet in front.
TEST(TcWords, JitterReordersAsInTheKernel) {
    EXPECT_TRUE(parsed_words("delay 50ms").in_order);
    EXPECT_FALSE(parsed_words("delay 50ms 10ms").in_order);
    EXPECT_TRUE(parsed_words("delay 50ms 10ms rate 1mbit").in_order);
    EXPECT_TRUE(parsed_words("delay 50ms 10ms ordered").in_order);
    EXPECT_FALSE(parsed_words("delay 50ms 10ms rate 1mbit unordered").in_order);
    EXPECT_FALSE(parsed_words("delay 50ms reorder 1%").in_order);
}

TEST(TcWords, DistributionsByName) {
    EXPECT_EQ(parsed_words("delay 50ms 10ms distribution normal").jitter.shape, JitterShape::kNormal);
    EXPECT_EQ(parsed_words("distribution pareto delay 50ms 10ms").jitter.shape, JitterShape::kPareto);
    EXPECT_EQ(parsed_words("delay 50ms 10ms dist paretonormal").jitter.shape, JitterShape::kParetoNormal);
    EXPECT_EQ(parsed_words("delay 50ms 10ms distribution uniform").jitter.shape, JitterShape::kUniform);
    std::string asked;
    const TcWays link = parse_tc("delay 50ms 10ms distribution mine", [&](std::string_view name) {
        asked = name;
        return std::make_shared<const JitterTable>(std::vector<double>{-1, 1});
    });
    EXPECT_EQ(asked, "mine");
    EXPECT_EQ(link.up.jitter.shape, JitterShape::kTable);
    EXPECT_TRUE(link.up.jitter.table);
}

TEST(TcWords, LossModelsWithTcsDefaults) {
    EXPECT_EQ(parsed_words("loss 0.5%").loss, LossSettings::independent(0.005));
    EXPECT_EQ(parsed_words("loss random 0.5").loss, LossSettings::independent(0.005));
    EXPECT_EQ(parsed_words("drop 0.1%").loss.probability, 0.001);
    const LossSettings ge = parsed_words("loss gemodel 1% 10% 70% 0.1%").loss;
    EXPECT_EQ(ge.shape, LossShape::kGilbertElliott);
    EXPECT_EQ(ge.good_to_bad, 0.01);
    EXPECT_EQ(ge.bad_to_good, 0.1);
    EXPECT_EQ(ge.loss_in_bad, 0.7);
    EXPECT_EQ(ge.loss_in_good, 0.001);
    EXPECT_DOUBLE_EQ(stationary_loss(parsed_words("loss gemodel 1%").loss), 0.01);  // "the Bernoulli model"
    EXPECT_DOUBLE_EQ(stationary_loss(parsed_words("loss state 1%").loss), 0.01);
    const LossSettings four = parsed_words("loss state 1% 20% 10% 30% 0.1%").loss;
    EXPECT_EQ(four.shape, LossShape::kFourState);
    EXPECT_EQ(std::vector({four.p13, four.p31, four.p32, four.p23, four.p14}),
              std::vector({0.01, 0.2, 0.1, 0.3, 0.001}));
}

TEST(TcWords, CorrelatedLossKeepsItsShare) {
    const TcWays link = parse_tc("loss 1% 25%");
    EXPECT_EQ(link.up.loss.shape, LossShape::kGilbertElliott);
    EXPECT_DOUBLE_EQ(stationary_loss(link.up.loss), 0.01);
    EXPECT_NEAR(1 - link.up.loss.good_to_bad - link.up.loss.bad_to_good, 0.25, 1e-12);
    EXPECT_THAT(link.notes, Contains(HasSubstr("Gilbert")));
}

TEST(TcWords, TheRest) {
    const TcWays all = parse_tc(
        "delay 50ms duplicate 1% corrupt 0.1% reorder 25% 50% gap 5 rate 1mbit 20 limit 1000 slot 800us 10ms "
        "packets "
        "42 bytes 64k");
    EXPECT_EQ(all.up.duplicate, 0.01);
    EXPECT_EQ(all.up.corrupt, 0.001);
    EXPECT_EQ(all.up.corrupt_bits, 1U);
    EXPECT_EQ(all.up.reorder, 0.25);
    EXPECT_EQ(all.up.reorder_gap, 5U);
    EXPECT_FALSE(all.up.in_order);
    EXPECT_EQ(all.up.rate.bits_per_s, 1e6);
    EXPECT_EQ(all.up.rate.overhead_bytes, 20U);
    EXPECT_EQ(all.up.capacity, 1000U);
    EXPECT_EQ(parsed_words("rate 5kbit 20 100 5").rate, (RateSettings{5e3, 20, 0, 0, Drop::kTail, 100, 5}));
    EXPECT_EQ(parsed_words("slot distribution paretonormal 5ms 2ms bytes 64k").slot,
              (SlotSettings{milliseconds{3}, milliseconds{7}, 0, 65536, JitterShape::kParetoNormal}));
    EXPECT_TRUE(parsed_words("loss 1% ecn").ecn);
    EXPECT_EQ(parse_tc("loss 1% seed 7").seed, 7U);
    EXPECT_EQ(all.up.slot, (SlotSettings{microseconds{800}, milliseconds{10}, 42, 65536}));
    EXPECT_THAT(all.notes,
                testing::ElementsAre(HasSubstr("reorder: the correlation of 50%"), HasSubstr("way up only")));
    EXPECT_THAT(parse_tc("duplicate 1% 0% corrupt 1% 0% both").notes, IsEmpty());
}

TEST(TcWords, TheQueueHoldsWhatTheDelayNeeds) {
    EXPECT_EQ(parsed_words("delay 50ms").capacity, LinkSettings{}.capacity);
    EXPECT_EQ(parsed_words("delay 10s").capacity, 20'002U);
    EXPECT_EQ(parsed_words("delay 10s limit 1000").capacity, 1000U);
}

TEST(TcWords, AWholeCommandMayBePasted) {
    EXPECT_EQ(parsed_words("tc qdisc add dev eth0 root netem delay 50ms"), parsed_words("delay 50ms"));
    EXPECT_EQ(parsed_words(""), LinkSettings{});
    EXPECT_TRUE(looks_like_tc_words("delay 50ms"));
    EXPECT_TRUE(looks_like_tc_words("tc qdisc add dev eth0 root netem loss 1%"));
    EXPECT_FALSE(looks_like_tc_words("leo"));
    EXPECT_FALSE(looks_like_tc_words("my file.toml"));
}

TEST(TcWords, RefusalsSayWhatAndWhy) {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"delay", "after 'delay': must be a time"},
        {"delay 50mn", "word 2, '50mn', must be a time"},
        {"delay -5ms", "must be a time"},
        {"delay 61s", "up to 60 s"},
        {"delay 5ms 1ms 100%", "below 100%"},
        {"delay 5ms delay 6ms", "twice"},
        {"latency 5ms delay 6ms", "twice"},
        {"jitter 5ms", "is not one of"},
        {"loss 101%", "from 0% to 100%"},
        {"loss 1% 100%", "all or nothing"},
        {"loss gemodel 0% 0%", "never moves"},
        {"loss state 60% 10% 10% 10% 50%", "p13 + p14"},
        {"loss state 1% 0%", "never end"},
        {"loss state 1% 50% 10% 0%", "never end"},
        {"loss ecn", "must be a share"},
        {"ecn", "give a loss"},
        {"seed x", "a whole number"},
        {"delay 5ms reorder 1% ordered", "contradicts"},
        {"distribution normal", "needs a delay and a jitter"},
        {"delay 5ms 1ms distribution", "must be uniform"},
        {"delay 5ms 1ms distribution no_such_table", "use uniform"},
        {"reorder 25%", "needs a delay"},
        {"gap 5", "give reorder"},
        {"rate 0.9bit", "from 1bit"},
        {"rate 1mbit -14", "negative overhead"},
        {"limit 0", "from 1 to 1000000"},
        {"slot 10ms 1ms", "second time must be the longer"},
        {"slot distribution 1ms 1ms", "must be uniform"},
        {"tc qdisc add dev eth0 root tbf rate 1mbit", "no \"netem\""},
        {std::string(70000, 'x'), "characters"}};
    for (const auto& [words, reason] : cases) EXPECT_THAT(tc_refusal_of(words), HasSubstr(reason)) << words;
}

TEST(TcUnits, RatesAndSizesAreTcs) {
    for (const auto& [word, bits_per_s] : {std::pair{"1mbit", 1e6},
                                           {"1Mibit", 1048576.0},
                                           {"125kbps", 1e6},
                                           {"1kibps", 8192.0},
                                           {"1000", 1000.0}})
        EXPECT_EQ(parse_tc_rate(word), bits_per_s) << word;
    for (const auto& [word, bytes] :
         {std::pair{"64k", 65536U}, {"8kbit", 1024U}, {"3b", 3U}, {"2gb", 2147483648U}})
        EXPECT_EQ(parse_tc_size(word), bytes) << word;
    for (const char* word : {"1ibit", "1kxbit", "1kib", "1k", "2tbit"})
        EXPECT_FALSE(parse_tc_rate(word)) << word;
    for (const char* word : {"8bit", "0t", "1bb", "1kib", "5g"}) EXPECT_FALSE(parse_tc_size(word)) << word;
    EXPECT_EQ(parse_tc_time("100", Duration{1}), Duration{100});
    EXPECT_EQ(parse_tc_time("100ns", microseconds{1}), Duration{100});
    for (const char* word : {"", "ms", "1xs", "nan", "inf", "-1", "1e999", "0x10"}) {
        EXPECT_FALSE(parse_tc_time(word, Duration{1})) << word;
    }
}

TEST(TcUnits, PrintingLosesNothing) {
    EXPECT_EQ(print_tc_time(microseconds{1500}), "1500us");
    EXPECT_EQ(print_tc_time(Duration{1500}), "1.5us");
    EXPECT_EQ(print_tc_share(0.005), "0.5%");
    EXPECT_EQ(print_tc_share(1e-5), "0.001%");
    EXPECT_EQ(print_tc_share(1), "100%");
    EXPECT_EQ(print_tc_rate(256e3), "256kbit");
    EXPECT_TRUE(rc::check("time, share and rate", [] {
        const Duration time{*rc::gen::inRange<std::int64_t>(0, 60'000'000'001)};
        RC_ASSERT(parse_tc_time(print_tc_time(time), microseconds{1}) == time);
        const double share = static_cast<double>(*rc::gen::inRange<std::int64_t>(0, INT64_MAX)) / 9.3e18;
        RC_ASSERT(parse_tc_share(print_tc_share(share)) == share);
        RC_ASSERT(parse_tc_rate(print_tc_rate(share * 1e11)) == share * 1e11);
    }));
}

double any_share() { return *rc::gen::inRange(1, 100'000) / 100'000.0; }

JitterSettings any_jitter(Duration delay) {
    JitterSettings jitter;
    jitter.shape = *rc::gen::element(JitterShape::kNone, JitterShape::kUniform, JitterShape::kNormal,
                                     JitterShape::kPareto, JitterShape::kParetoNormal);
    if (jitter.shape == JitterShape::kNone) return jitter;
    jitter.spread = Duration{*rc::gen::inRange<std::int64_t>(1, delay.count() + 1)};
    jitter.correlation = *rc::gen::element(0.0, 0.25, 0.999);
    return jitter;
}

LossSettings any_loss() {
    LossSettings loss;
    loss.shape = *rc::gen::element(LossShape::kNone, LossShape::kIndependent, LossShape::kGilbertElliott,
                                   LossShape::kFourState);
    if (loss.shape == LossShape::kIndependent) loss.probability = any_share();
    if (loss.shape == LossShape::kGilbertElliott) {
        loss.good_to_bad = any_share();
        loss.bad_to_good = any_share();
        loss.loss_in_bad = any_share();
        loss.loss_in_good = any_share();
    }
    if (loss.shape == LossShape::kFourState) {
        loss.p13 = any_share() / 2;
        loss.p14 = any_share() / 2;
        loss.p31 = any_share() / 2;
        loss.p32 = any_share() / 2;
        loss.p23 = any_share();
    }
    return loss;
}

LinkSettings any_link() {
    LinkSettings link;
    link.delay = Duration{*rc::gen::inRange<std::int64_t>(1, 60'000'000'001)};
    link.jitter = any_jitter(link.delay);
    link.loss = any_loss();
    if (*rc::gen::arbitrary<bool>()) link.duplicate = any_share();
    if (*rc::gen::arbitrary<bool>()) link.corrupt = any_share();
    if (*rc::gen::arbitrary<bool>()) {
        link.reorder = any_share();
        link.reorder_gap = *rc::gen::inRange(1U, 1000U);
        link.in_order = false;
    }
    if (*rc::gen::arbitrary<bool>()) {
        link.rate.bits_per_s = any_share() * *rc::gen::element(1e5, 1e7, 1e10);
        link.rate.overhead_bytes = *rc::gen::inRange<std::size_t>(0, 1000);
        link.rate.cell_bytes = *rc::gen::inRange<std::size_t>(0, 100);
        if (link.rate.cell_bytes > 0) link.rate.cell_overhead_bytes = *rc::gen::inRange<std::size_t>(0, 10);
    }
    if (*rc::gen::arbitrary<bool>()) {
        link.slot.least = Duration{*rc::gen::inRange(0, 1'000'000)};
        link.slot.most = link.slot.least + Duration{*rc::gen::inRange(1, 100'000'000)};
        link.slot.packets = *rc::gen::inRange<std::size_t>(0, 100);
        link.slot.bytes = *rc::gen::inRange<std::size_t>(0, 1'000'000);
    }
    if (link.slot.most > Duration::zero() && *rc::gen::arbitrary<bool>()) {
        link.slot.shape = *rc::gen::element(JitterShape::kNormal, JitterShape::kPareto);
        link.slot.most +=
            Duration{(link.slot.most - link.slot.least).count() % 2};  // a mean of whole nanoseconds
    }
    if (link.loss.shape != LossShape::kNone) link.ecn = *rc::gen::arbitrary<bool>();
    if (link.jitter.shape != JitterShape::kNone && link.rate.bits_per_s == 0) link.in_order = false;
    link.capacity = *rc::gen::inRange<std::size_t>(1, 1'000'001);
    return link;
}

TEST(TcPrint, WhatTcCanExpressComesBackUnchanged) {
    EXPECT_TRUE(rc::check("parse(print(x)) == x", [] {
        const LinkSettings link = any_link();
        const TcCommands printed = print_tc(link, "eth0");
        RC_LOG() << printed.words << "\n";
        RC_ASSERT(parsed_words(printed.words) == link);
        RC_ASSERT(parsed_words(printed.command) == link);
    }));
}

TEST(TcPrint, CommandReadsAsTcsDocumentation) {
    const TcCommands printed =
        print_tc(parsed_words("delay 50ms 10ms distribution normal loss 0.5% limit 1000"), "eth0");
    EXPECT_EQ(printed.command,
              "tc qdisc add dev eth0 root netem limit 1000 delay 50ms 10ms distribution normal "
              "loss random 0.5%");
    EXPECT_THAT(printed.cannot, IsEmpty());
    EXPECT_THAT(print_tc(parsed_words("delay 50ms 10ms ordered"), "eth0").cannot,
                testing::ElementsAre(HasSubstr("overtake")));
    EXPECT_THAT(print_tc(parsed_words("delay 50ms 10ms rate 1mbit unordered"), "eth0").cannot,
                Contains(HasSubstr("with a rate tc keeps the order")));
    EXPECT_THAT(print_tc(parsed_words("delay 50ms"), "eth0").cannot, IsEmpty());
}

TEST(TcPrint, WhatTcCannotDoIsNamed) {
    LinkSettings link = parsed_words("delay 50.0005ms 10ms 60% distribution pareto corrupt 1% rate 1mbit");
    link.corrupt_bits = 8;
    link.rate.drop = Drop::kHead;
    link.rate.queue_packets = 10;
    link.outages.push_back({});
    const auto cannot = print_tc(link, "eth0").cannot;
    for (const char* what : {"microseconds", "50 % of the spread", "0.82", "not 8", "tbf", "oldest",
                             "Ethernet header", "outages"}) {
        EXPECT_THAT(cannot, Contains(HasSubstr(what))) << what;
    }
    link.jitter.shape = JitterShape::kGamma;
    EXPECT_THAT(print_tc(link, "eth0").cannot, Contains(HasSubstr("no gamma")));
    EXPECT_THAT(print_tc(parsed_words("slot distribution uniform 1ms 2ms"), "eth0").cannot,
                Contains(HasSubstr("uniform gaps")));
    const LinkSettings overtaking = parsed_words("delay 50ms reorder 25% gap 5");
    EXPECT_THAT(print_tc(overtaking, "eth0").cannot, IsEmpty());
    link = overtaking;
    link.rate.bits_per_s = 1e6;
    EXPECT_THAT(print_tc(link, "eth0").cannot, Contains(HasSubstr("skips tc's rate")));
}

}  // namespace
}  // namespace thimble
