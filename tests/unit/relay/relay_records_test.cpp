// The packet log, its records, and the report.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/packet_log.hpp"
#include "netem/relay/relay_report.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

PacketRecord sample(std::uint64_t packet) {
    return {.packet = packet,
            .received_ns = 1'000'000'000,
            .due_ns = 1'050'000'000,
            .sent_ns = 1'050'012'345,
            .flow = 7,
            .bytes = 104,
            .inlet = 2,
            .direction = RelayDirection::kDown,
            .fate = LoggedFate::kSent,
            .corrupted = false,
            .copy = true};
}

TEST(DelayMoments, AreThoseOfTheSamples) {
    DelayMoments moments;
    EXPECT_EQ(moments.deviation_s(), 0);
    for (const int ms : {40, 50, 60}) moments.add(std::chrono::milliseconds{ms});
    EXPECT_NEAR(moments.mean_s(), 0.05, 1e-12);
    EXPECT_NEAR(moments.deviation_s(), 0.01, 1e-12);
    EXPECT_NEAR(moments.sum_s(), 0.15, 1e-12);
}

TEST(RelayReport, SaysWhatBecomesOfTheOrder) {
    LinkSettings link{.delay = std::chrono::milliseconds{50}};
    EXPECT_EQ(order_text(link), "");
    link.jitter = {JitterShape::kNormal, std::chrono::milliseconds{10}};
    EXPECT_THAT(order_text(link), HasSubstr("far above 50 ms"));
    link.in_order = false;
    EXPECT_THAT(order_text(link), HasSubstr("overtake"));
}

class LogFile : public testing::Test {
  protected:
    std::string path(const char* name) { return path_ = folder_ / name; }
    std::string text() const { return read_text(path_); }
    TemporaryDirectory folder_;
    std::string path_;
};

RC_GTEST_PROP(PacketRecord, ComesBackAsItWas, (std::uint64_t packet, std::int64_t ns, std::uint32_t flow)) {
    PacketRecord r = sample(packet);
    r.received_ns = ns;
    r.due_ns = -ns;
    r.flow = flow;
    r.corrupted = flow % 2 == 0;
    r.fate = static_cast<LoggedFate>(flow % kLoggedFates);
    RC_ASSERT(decode_record(encode(r)) == r);
}

TEST(PacketRecord, LiesInTheFileAsItsHeaderSays) {
    const auto bytes = encode(sample(0x0102030405060708));
    for (const auto& [place, value] :
         {std::pair{0, 8}, {7, 1}, {32, 7}, {36, 104}, {40, 2}, {42, 1}, {44, 2}})
        EXPECT_EQ(bytes[static_cast<std::size_t>(place)], value) << place;
}

TEST(PacketRecord, RefusesWhatIsNone) {
    for (const auto& [place, value] : {std::pair<std::size_t, std::uint8_t>{43, 99}, {42, 2}, {47, 1}}) {
        auto bytes = encode(sample(1));
        bytes[place] = value;
        EXPECT_FALSE(decode_record(bytes)) << place;
    }
}

TEST(PacketRecord, IsALineOfCsv) {
    EXPECT_EQ(to_csv(sample(3)), "2,7,down,3,104,sent,0,1,1000000000,1050000000,1050012345");
    PacketRecord lost = sample(4);
    lost.fate = LoggedFate::kLost;
    lost.due_ns = lost.sent_ns = 0;
    lost.copy = false;
    EXPECT_EQ(to_csv(lost), "2,7,down,4,104,lost,0,0,1000000000,,");
}

TEST_F(LogFile, IsWrittenToItsEnd) {
    PacketLog log(path("log.bin"));
    for (std::uint64_t i = 0; i < 1000; ++i) log.add(sample(i));
    log.finish();
    const std::string all = text();
    ASSERT_EQ(all.size(), kLogHeaderBytes + 1000 * kRecordBytes);
    std::array<std::uint8_t, kRecordBytes> last{};
    std::copy(all.end() - kRecordBytes, all.end(), last.begin());
    EXPECT_EQ(decode_record(last), sample(999));
    EXPECT_EQ(log.missing(), 0U);
}

TEST_F(LogFile, IsTextIfItsNameSaysSo) {
    PacketLog log(path("log.csv"));
    log.add(sample(5));
    log.finish();
    EXPECT_EQ(text(), std::string(record_csv_header()) + "\n" + to_csv(sample(5)) + "\n");
}

// More at once than the queue holds: what is missing is counted, and marked where it is missing.
TEST_F(LogFile, MarksWhatItCouldNotKeep) {
    PacketLog log(path("log.csv"), 4);
    std::uint64_t added = 0, missing = 0;
    while (added < 100'000) log.add(sample(added++));
    EXPECT_GT(log.missing(), 0U);
    // Until the thread has made room.
    for (const SessionTime end = wall_now() + std::chrono::seconds{60}; wall_now() < end;) {
        wall_sleep(std::chrono::milliseconds{5});
        missing = log.missing();
        log.add(sample(added++));
        if (log.missing() == missing) break;
    }
    EXPECT_EQ(log.missing(), missing);
    log.finish();
    EXPECT_THAT(text(), HasSubstr(",gap,"));
    EXPECT_THAT(text(), HasSubstr(fmt::format(",{},104,sent,", added - 1)));
    const std::string all = text();
    std::uint64_t sent = 0;
    for (std::size_t at = all.find(",sent,"); at != std::string::npos; at = all.find(",sent,", at + 1))
        ++sent;
    EXPECT_EQ(sent, added - log.missing());
}

TEST_F(LogFile, MarksWhatIsMissingAtItsEnd) {
    PacketLog log(path("log.bin"), 4);
    for (std::uint64_t i = 0; i < 100'000; ++i) log.add(sample(i));
    log.finish();
    const std::string all = text();
    std::uint64_t marked = 0;
    std::array<std::uint8_t, kRecordBytes> bytes{};
    for (std::size_t at = kLogHeaderBytes; at < all.size(); at += kRecordBytes) {
        std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(at), kRecordBytes, bytes.begin());
        const PacketRecord record = decode_record(bytes).value();
        marked += record.fate == LoggedFate::kGap ? record.packet : 0;
    }
    EXPECT_EQ(marked, log.missing());
    EXPECT_GT(marked, 0U);
}

TEST_F(LogFile, NeedsAFolder) { EXPECT_THROW(PacketLog("/nowhere/at/all.bin"), Error); }

TEST(LogHeader, SaysWhatItIsNot) {
    const auto good = log_header();
    EXPECT_NO_THROW(check_log_header(good, "a"));
    EXPECT_THROW(check_log_header({good.data(), 7}, "a"), Error);
    for (const std::size_t place : {0U, 8U}) {
        auto other = good;
        other[place] = 2;
        EXPECT_THROW(check_log_header(other, "a"), Error) << place;
    }
}

// Against R: prop.test(10, 100, correct = FALSE)$conf.int, and so on.
TEST(Wilson, IsTheScoreInterval) {
    const ProportionInterval ten = wilson_95(10, 100);
    EXPECT_NEAR(ten.low, 0.05522914, 1e-8);
    EXPECT_NEAR(ten.high, 0.1743657, 1e-7);
    const ProportionInterval none = wilson_95(0, 3200);
    EXPECT_EQ(none.low, 0);
    EXPECT_NEAR(none.high, 3.8414588 / (3200 + 3.8414588), 1e-9);
    EXPECT_EQ(wilson_95(5, 5).high, 1);
    EXPECT_EQ(wilson_95(0, 0).low, 0);
    EXPECT_EQ(wilson_95(0, 0).high, 1);
}

TEST(RelayReport, SaysAskedAndAchieved) {
    RelayState state;
    state.links.up.delay = std::chrono::milliseconds{50};
    state.links.up.loss = LossSettings::independent(0.25);
    DirectionTotals& up = state.totals.direction[0];
    up.packets.pushed = 16;  // a link asks its loss model first, also in an outage
    up.packets.outage = 7;
    up.packets.oversized = 2;
    up.packets.lost = 4;
    up.packets.delivered = 3;
    up.refused = 1;
    for (int i = 0; i < 2; ++i) {
        up.delay.add(std::chrono::microseconds{50'020});
        up.error.add(std::chrono::microseconds{20});
    }
    const auto json = describe(state);
    EXPECT_EQ(json.at("up").at("packets").at("sent"), 2);
    EXPECT_EQ(json.at("up").at("packets").at("refused_by_kernel"), 1);
    EXPECT_DOUBLE_EQ(json.at("up").at("loss").at("asked").get<double>(), 0.25);
    EXPECT_DOUBLE_EQ(json.at("up").at("loss").at("achieved").get<double>(), 0.25);
    EXPECT_NEAR(json.at("up").at("due_time_error").at("median_us").get<double>(), 20, 0.1);
    for (const char* said : {"asked 50 ms", "asked 25 %", "1 refused_by_kernel"})
        EXPECT_THAT(report_text(json), HasSubstr(said));
    EXPECT_EQ(describe(RelayState{}).at("up").at("loss").at("achieved"), 0);
}

}  // namespace
}  // namespace thimble
