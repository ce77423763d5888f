// Jitter tables, packet traces and delivery traces: read, written, refused.
#include "netem/formats/trace_files.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/error.hpp"
#include "netem/formats/jitter_table_file.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::StartsWith;

std::string table_refusal(std::string_view text) {
    return refusal([&] { parse_jitter_table(text, "a.dist"); });
}
std::string delivery_refusal(std::string_view text) {
    return refusal([&] { parse_delivery_trace(text, "a.pdo"); });
}

TEST(JitterTableFile, ReadsWhatTcReads) {
    const JitterTable table = parse_jitter_table("# a comment\n\n -8192 -4096\t0\r\n8192 16384\n", "a.dist");
    EXPECT_EQ(table.deviates(), (std::vector{-1.0, -0.5, 0.0, 1.0, 2.0}));
    EXPECT_EQ(parse_jitter_table("3 1 2", "a").deviates(), parse_jitter_table("1 2 3", "a").deviates());
}

TEST(JitterTableFile, RefusesWithFileAndLine) {
    EXPECT_THAT(table_refusal(""), StartsWith("a.dist:1: "));
    EXPECT_THAT(table_refusal("# only\n5\n"), StartsWith("a.dist:2: a table needs at least two"));
    EXPECT_THAT(table_refusal("1 2\n3 x\n"), StartsWith("a.dist:2: 'x'"));
    EXPECT_THAT(table_refusal("1 40000\n"), HasSubstr("-32768 to 32767"));
    EXPECT_THAT(table_refusal("1.5 2\n"), HasSubstr("whole number"));
    std::string many;
    for (int i = 0; i < 16385; ++i) many += "1 ";
    EXPECT_THAT(table_refusal(many), HasSubstr("16384"));
}

TEST(JitterTableFile, WhatIsWrittenIsReadAgain) {
    std::vector<double> deviates;
    for (int i = -2000; i < 2000; ++i) deviates.push_back(std::round(i * 1.5) / kDistScale);
    const std::string text = print_jitter_table(JitterTable(deviates), "two\nlines", deviates.size());
    EXPECT_THAT(text, StartsWith("# two lines\n"));
    EXPECT_EQ(parse_jitter_table(text, "a").deviates(), deviates);
}

TEST(PacketTraceFile, ReadsTheHousesNamesAndOthersInAnyOrder) {
    const PacketTrace house = parse_packet_trace(
        "time_s,delay_s,loss,rate_bits_per_s\n0,0.05,0,1e6\n0.001,0.06,1,2e6\n", "a.csv", {});
    EXPECT_EQ(house.rows()[1], (TraceRow{1'000'000, milliseconds{60}, 1, 2e6}));
    EXPECT_EQ(house.layout(),
              (TraceLayout{TraceBy::kTime, TraceBetween::kHold, TraceEnd::kWrap, true, true, true}));
    const PacketTrace other = parse_packet_trace(
        "# from elsewhere\r\nrate_kbps, loss ,t_us,delay_us\r\n1000,0,0,50000\r\n\r\n2000,1,1000,60000\r\n",
        "b.csv", {});
    EXPECT_EQ(house.rows(), other.rows());
}

TEST(PacketTraceFile, ByPacketCountsLinesUnlessTheyAreNumbered) {
    constexpr std::string_view kTimes = "time_s,delay_s\n0,0.1\n5,0.2\n";
    EXPECT_EQ(parse_packet_trace(kTimes, "a", {.by = TraceBy::kPacket}).rows()[1].at, 1);
    const PacketTrace numbered = parse_packet_trace("packet,loss\n0,0\n10,1\n", "a", {});
    EXPECT_EQ(numbered.layout().by, TraceBy::kPacket);
    EXPECT_EQ(numbered.rows()[1].at, 10);
    EXPECT_FALSE(numbered.layout().has_delay);
    EXPECT_THROW(parse_packet_trace("packet,loss\n0,0\n", "a", {.by = TraceBy::kTime}), Error);
    const PacketTrace linear =
        parse_packet_trace(kTimes, "a", {.between = TraceBetween::kLinear, .end = TraceEnd::kHold});
    EXPECT_EQ(linear.layout().between, TraceBetween::kLinear);
    EXPECT_EQ(linear.layout().end, TraceEnd::kHold);
}

TEST(PacketTraceFile, LostPacketsHoldTheDelayBeforeThem) {
    const PacketTrace trace =
        parse_packet_trace("time_s,delay_s,loss\n0,,1\n1,0.1,0\n2,,1\n3,0.3,0\n", "a", {});
    std::vector<Duration> delays;
    for (const TraceRow& row : trace.rows()) delays.push_back(row.delay);
    EXPECT_EQ(delays, (std::vector<Duration>{milliseconds{100}, milliseconds{100}, milliseconds{100},
                                             milliseconds{300}}));
}

TEST(PacketTraceFile, RefusesWithFileAndLine) {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"", "a.csv:1: is empty"},
        {"# nothing\n", "a.csv:1: is empty"},
        {"time_s,delay_s\n", "a.csv:1: there is a header"},
        {"time_s,delay\n", "a.csv:1: unknown column 'delay'"},
        {"time_s,t_us,loss\n", "a.csv:1: column 't_us' appears twice"},
        {"time_s,packet,loss\n", "both times and packet"},
        {"delay_s,loss\n0,0\n", "needs a column time_s"},
        {"time_s\n0\n", "neither delay_s nor loss"},
        {"time_s,loss\n0,0\n0,1\n", "a.csv:3: times must rise"},
        {"packet,loss\n3,0\n2,1\n", "a.csv:3: packet numbers must rise"},
        {"packet,loss\n1.5,0\n", "a.csv:2: packet: must be a whole number"},
        {"packet,loss\n9007199254740993,0\n", "a.csv:2: packet: must be a whole number from 0 to"},
        {"time_s,loss\n0\n", "a.csv:2: has 1 fields, the header 2"},
        {"time_s,loss\n0,2\n", "loss: 2 must lie between 0 and 1"},
        {"time_s,delay_s\n-1,0\n", "a.csv:2: time_s: -1 must lie"},
        {"time_s,delay_s\n0,nan\n", "not a finite number"},
        {"time_s,delay_s\n0,61\n", "between 0 and 60"},
        {"time_s,delay_s,loss\n0,,0\n", "empty only where loss is 1"},
        {"time_s,rate_kbps\n0,0.0009\n", "rate: must be at least 1 bit/s"},
        {"t_us,loss\n4e15,0\n", "a.csv:2: t_us"}};
    for (const auto& [text, why] : cases)
        EXPECT_THAT(refusal([&, &csv = text] { parse_packet_trace(csv, "a.csv", {}); }), HasSubstr(why))
            << text;
}

TEST(PacketTraceFile, WhatIsWrittenIsReadAgain) {
    EXPECT_TRUE(rc::check("the same path", [] {
        MeasuredPath path;
        path.by_packet = *rc::gen::arbitrary<bool>();
        path.has_delay = path.has_loss = true;
        path.remarks = {"Its clock is a guess.", "50 % of it"};
        path.has_rate = *rc::gen::arbitrary<bool>();
        std::int64_t at = *rc::gen::inRange(0, 1000);
        for (int i = *rc::gen::inRange(1, 20); i > 0; --i) {
            at += *rc::gen::inRange<std::int64_t>(1, 10'000'000'000);
            path.packets.push_back({at, Duration{*rc::gen::inRange<std::int64_t>(0, 60'000'000'000)},
                                    *rc::gen::inRange(0, 1000) / 999.0,
                                    path.has_rate ? *rc::gen::inRange(3, 1 << 30) / 3.0 : 0});
        }
        const std::string text = print_path(path);
        RC_LOG() << text;
        RC_ASSERT(parse_path(text, "a") == path);
    }));
}

TEST(PacketTraceFile, CommentsAboveTheHeaderAreRemarks) {
    EXPECT_EQ(parse_path("#\tone \n\ntime_s,loss\n# of a line\n0,0\n", "a").remarks,
              std::vector<std::string>{"one"});
}

TEST(DeliveryTraceFile, ReadsAndRefuses) {
    EXPECT_EQ(parse_delivery_trace("0\n 1\r\n1\n5\n", "a.pdo").times_ms(),
              (std::vector<std::uint32_t>{0, 1, 1, 5}));
    EXPECT_THAT(delivery_refusal(""), StartsWith("a.pdo:1: is empty"));
    EXPECT_THAT(delivery_refusal("5\n4\n"), StartsWith("a.pdo:2: times must not fall"));
    EXPECT_THAT(delivery_refusal("5\n\n6\n"), StartsWith("a.pdo:2: ''"));
    EXPECT_THAT(delivery_refusal("1.5\n"), StartsWith("a.pdo:1: '1.5'"));
    EXPECT_THAT(delivery_refusal("-1\n"), HasSubstr("whole number"));
    EXPECT_THAT(delivery_refusal("0\n0\n"), HasSubstr("above 0"));
}

}  // namespace
}  // namespace thimble
