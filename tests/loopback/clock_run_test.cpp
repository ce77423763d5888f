// Clocks in a real run: all processes share this machine's clock, so the truth is 0 and every exchange must contain it.
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/clocks/clock_summary.hpp"
#include "session/run/session_process.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

TEST(ClocksOfARun, EveryExchangeContainsTheTruth) {
    RealRun run(SessionFile{});
    ASSERT_EQ(run.end(), 0) << run.words();
    std::map<Role, int> exchanges;
    for (const ClockRecord& record : read_clock_file(run.out() / "nodes" / "clocks_0ms.csv")) {
        ++exchanges[record.node];
        EXPECT_LE(record.exchange.low(), Duration{}) << to_string(record.node);
        EXPECT_GE(record.exchange.high(), Duration{}) << to_string(record.node);
    }
    for (const Role node : kNodeRoles) EXPECT_GE(exchanges[node], 3) << to_string(node);
    const auto summary = nlohmann::json::parse(read_text(run.out() / "summary.json"));
    EXPECT_THAT(summary["sections"].back().dump(), testing::HasSubstr("\"Clocks\""));
    EXPECT_THAT(summary["provenance"]["clock daemon"], testing::HasSubstr("chrony"));
}

}  // namespace
}  // namespace thimble
