// thimble-bench chain where no clock is asked: quantiles of windows, ratios, and what it reads in the nodes' reports.
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/network/bare_chain.hpp"
#include "bench/network/chain_figures.hpp"
#include "common/codec.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

using ChainJson = nlohmann::ordered_json;

std::vector<double> one_to(std::size_t count) {
    std::vector<double> values(count);
    std::iota(values.begin(), values.end(), 1.0);
    return values;
}

std::vector<ChainJson> node_reports() {
    return {{{"program", "thimble-netem"}, {"turns", {{"median_us", 30.0}}}},
            {{"program", "thimble-slave-sim"}, {"turns", {{"median_us", 20.0}}}},
            {{"program", "thimble-master"},
             {"turns", {{"median_us", 7.0}}},
             {"round_trip", {{"median_us", 84.0}, {"p99_us", 238.0}, {"worst_us", 1200.0}, {"count", 1000}}},
             {"hold", {{"median_us", 0.0}}}}};
}

std::string refusal_of(const std::vector<ChainJson>& reports) {
    try {
        read_chain_round(reports);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kData);
        return error.what();
    }
    return "";
}

TEST(ErrorWindows, QuantilesOfAWindowCountAsItsErrorsWould) {
    ErrorWindows by_errors, by_quantiles;
    by_errors.add(one_to(1001));
    by_quantiles.add(WindowQuantiles{501, 991, 1001, 1001});
    EXPECT_EQ(by_errors.errors().w50_us, 501);
    EXPECT_EQ(by_errors.errors().w99_us, 991);
    EXPECT_EQ(by_errors.errors().stalled, 1);
    EXPECT_EQ(by_quantiles.errors().w50_us, by_errors.errors().w50_us);
    EXPECT_EQ(by_quantiles.errors().w99_us, by_errors.errors().w99_us);
    EXPECT_EQ(by_quantiles.errors().stalled, by_errors.errors().stalled);
}

TEST(ErrorWindows, AWindowOfAFewIsNotJudged) {
    ErrorWindows windows;
    windows.add(WindowQuantiles{5000, 5000, 5000, 19});
    windows.add(WindowQuantiles{10, 20, 30, 20});
    EXPECT_EQ(windows.errors().w50_us, 10);
    EXPECT_EQ(windows.errors().stalled, 0);
}

TEST(ChainRound, IsReadFromTheNodesReportsInAnyOrder) {
    const ChainRound round = read_chain_round(node_reports());
    EXPECT_EQ(round.round_trip.median_us, 84);
    EXPECT_EQ(round.round_trip.p99_us, 238);
    EXPECT_EQ(round.round_trip.worst_us, 1200);
    EXPECT_EQ(round.round_trip.count, 1000U);
    EXPECT_EQ(round.master_turn_us, 7);
    EXPECT_EQ(round.netem_turn_us, 30);
    EXPECT_EQ(round.slave_turn_us, 20);
}

TEST(ChainRound, AReportThatIsMissingOrOlderIsNamed) {
    auto reports = node_reports();
    reports.erase(reports.begin());
    EXPECT_THAT(refusal_of(reports), testing::HasSubstr("thimble-netem"));
    reports = node_reports();
    reports.back().erase("round_trip");
    EXPECT_THAT(refusal_of(reports), testing::HasSubstr("thimble-master has no number round_trip.median_us"));
    reports = node_reports();
    reports.back()["round_trip"]["p99_us"] = "fast";
    EXPECT_THAT(refusal_of(reports), testing::HasSubstr("round_trip.p99_us"));
    reports.front() = ChainJson::array();
    EXPECT_NE(refusal_of(reports), "");
}

TEST(ChainFigures, WeighTheChainAgainstAsManyHops) {
    ChainFigures figures("default");
    for (const double median_us : {80.0, 90.0, 100.0}) {
        ChainRound round;
        round.round_trip = {median_us, 3 * median_us, 10 * median_us, 1000};
        round.netem_turn_us = median_us / 3;
        figures.add_chain(round);
        figures.add_bare(std::vector<double>(100, median_us / 1.5));
        figures.add_ping_pong({20, 45, 50, 1000});
    }
    const auto rows = figures.rows();
    ASSERT_EQ(rows.size(), 4U);
    EXPECT_DOUBLE_EQ(rows[0].chain_us, 90);
    EXPECT_DOUBLE_EQ(rows[0].bare_us, 60);
    EXPECT_DOUBLE_EQ(rows[0].ratio(), 1.5);
    EXPECT_DOUBLE_EQ(rows[1].chain_us, 270);
    EXPECT_DOUBLE_EQ(rows[2].bare_us, 40);  // four hops are two there and back
    EXPECT_DOUBLE_EQ(rows[3].ratio(), 3);
    EXPECT_THAT(figures.table(), testing::AllOf(testing::HasSubstr("scheduling: default"),
                                                testing::HasSubstr("| 90.0 us | 60.0 us | 1.500 | <= 1.3 |"),
                                                testing::HasSubstr("netem 30.0 us")));
    EXPECT_EQ(figures.json()["rows"].size(), 4U);
    EXPECT_EQ(figures.json()["stalled_windows"]["chain"], 0);
}

TEST(ChainFigures, NothingMeasuredIsNoRatio) {
    for (const ChainRow& row : ChainFigures("SCHED_FIFO").rows()) EXPECT_EQ(row.ratio(), 0) << row.what;
}

// The bare processes send what the programs send.
TEST(BareChain, DatagramsAreAsLongAsTheMessages) {
    Encoder encoder;
    EXPECT_EQ(encoder.encode(Header{}, NeedleCommand{}).size(), kNeedleBytes);
    EXPECT_EQ(encoder.encode(Header{}, ForceFeedback{}).size(), kForceBytes);
}

TEST(ChainTrials, AreOneOfEachModalityWithoutDelay) {
    std::vector<Modality> modalities;
    for (const TrialConditions& trial : chain_trials()) {
        modalities.push_back(trial.modality);
        EXPECT_EQ(trial.delay_s, 0);
    }
    EXPECT_THAT(modalities, testing::UnorderedElementsAreArray(kModalities));
}

}  // namespace
}  // namespace thimble
