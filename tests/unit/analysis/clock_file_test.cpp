// The records of clocks: the raw file, the table made from it, and chrony's words.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/report/run_tables.hpp"
#include "common/error.hpp"
#include "session/clocks/chrony.hpp"
#include "session/clocks/clock_summary.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

class ClockFileTest : public testing::Test {
  protected:
    void write(const std::string& lines) {
        std::ofstream(path) << "node,sent_ns,arrived_node_ns,replied_node_ns,answered_ns,offset_s,bound_s\n"
                            << lines;
    }
    TemporaryDirectory directory;
    std::filesystem::path path = directory / "clocks.csv";
};

TEST_F(ClockFileTest, StampsComeBackToTheNanosecond) {
    const ClockExchange e{from_nanoseconds(1'000'000'001), from_nanoseconds((std::int64_t{1} << 62) - 3),
                          from_nanoseconds((std::int64_t{1} << 62) - 2), from_nanoseconds(1'000'050'000)};
    {
        ClockWriter writer(path);
        writer.append(Role::kSlaveSim, e);
        writer.append(Role::kNetem, {});
    }
    const auto records = read_clock_file(path);
    ASSERT_EQ(records.size(), 2U);
    EXPECT_EQ(records[0].node, Role::kSlaveSim);
    EXPECT_EQ(records[0].exchange.sent, e.sent);
    EXPECT_EQ(records[0].exchange.arrived, e.arrived);
    EXPECT_EQ(records[0].exchange.replied, e.replied);
    EXPECT_EQ(records[0].exchange.answered, e.answered);
    EXPECT_EQ(records[1].node, Role::kNetem);
}

TEST_F(ClockFileTest, WhatCannotBeIsRefusedWithItsPlace) {
    const auto complaint = [&](const std::string& lines) {
        write(lines);
        return refusal([&] { read_clock_file(path); });
    };
    EXPECT_EQ(complaint("master,1,2,2,3,0,1\n"), "nothing was refused");
    EXPECT_THAT(complaint("butler,1,2,2,3,0,1\n"), HasSubstr("no node"));
    EXPECT_THAT(complaint("master,1,2,2,-3,0,1\n"), HasSubstr("answered_ns"));
    EXPECT_THAT(complaint("master,1,2,2,0,0,1\n"), HasSubstr("impossible for any two clocks"));
    EXPECT_NE(complaint("master,1,2,2,3,0,1"), "nothing was refused");  // cut off
}

TEST(ClockTable, ARowPerNodeThatAnswered) {
    std::vector<ClockRecord> records;
    for (int i = 0; i < 5; ++i) {
        const std::int64_t t = 1'000'000'000 + 200'000'000 * i;
        records.push_back({Role::kMaster,
                           {from_nanoseconds(t), from_nanoseconds(t + 3'000'050'000),
                            from_nanoseconds(t + 3'000'050'000), from_nanoseconds(t + 100'000)}});
    }
    records.push_back({Role::kVisual, records[0].exchange});
    const ReportTable table = clock_table(clocks_of(0.05, records));
    ASSERT_EQ(table.rows.size(), 2U);
    for (const auto& row : table.rows) ASSERT_EQ(row.size(), table.columns.size());
    EXPECT_EQ(table.rows[0][1], "master");
    EXPECT_EQ(table.rows[0][2], "3.000000");
    EXPECT_EQ(table.rows[0][3], "50.0");
    EXPECT_EQ(table.rows[0][5], "5");
    EXPECT_EQ(table.rows[1][4], "not known");  // a single exchange says nothing about a rate
    EXPECT_THAT(table.rows[0][7], HasSubstr("not known: +-50"));
}

TEST(Chrony, TrackingIsRead) {
    const auto tracking = parse_chrony_tracking(
        "C0000201,192.0.2.1,3,1700000000.123,0.000001000,-0.000012500,0.000020000,-12.345,0.001,0.050,0."
        "012000000,0.000340000,64.2,Normal\n");
    ASSERT_TRUE(tracking);
    EXPECT_EQ(tracking->reference, "192.0.2.1");
    EXPECT_EQ(tracking->stratum, 3U);
    EXPECT_DOUBLE_EQ(tracking->last_offset_s, -12.5e-6);
    EXPECT_DOUBLE_EQ(tracking->root_dispersion_s, 340e-6);
    EXPECT_EQ(describe(*tracking),
              "chrony follows 192.0.2.1 (stratum 3), last offset -12.5 us, root dispersion 340.0 us");
}

TEST(Chrony, WhatIsNoTrackingIsNone) {
    for (const char* text :
         {"", "506 Cannot talk to daemon\n", "a,b,c", "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15",
          "C0,192.0.2.1,3,1,1,nan,1,1,1,1,1,1,1,Normal", "C0,192.0.2.1,three,1,1,1,1,1,1,1,1,1,1,Normal"}) {
        EXPECT_FALSE(parse_chrony_tracking(text)) << text;
    }
    EXPECT_THAT(describe_chrony(), HasSubstr("chrony"));
}

}  // namespace
}  // namespace thimble
