// Whole runs with all five nodes, as `thimble run` makes them.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/clocks/clock_summary.hpp"
#include "session/run/session_process.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

constexpr double kDelay_s = 0.05;

const TrialRow& row_of(const std::vector<TrialRow>& rows, Modality modality, double delay_s) {
    return *std::find_if(rows.begin(), rows.end(), [&](const TrialRow& row) {
        return row.conditions.modality == modality && row.conditions.delay_s == delay_s;
    });
}

void expect_on_disk(const RealRun& run, const TrialRow& row) {
    EXPECT_EQ(row.reason, EndReason::kCompleted);
    EXPECT_TRUE(row.metrics.beeped);
    EXPECT_EQ(row.conditions.fixture_position_m, 0.035);
    const Trajectory trajectory = read_trajectory(run.trajectory_path(row.conditions));
    EXPECT_EQ(trajectory.reason, EndReason::kCompleted);
    EXPECT_GT(trajectory.samples.size(), 300U);  // 0.3 s of contact at 1 kHz
}

TEST(RunInLockStep, AllModalitiesWithAndWithoutDelay) {
    SessionFile session;
    session.modalities = R"(["HF", "CF", "CCF", "VF"])";
    session.delays_s = "[0.0, 0.05]";
    session.parallel_conditions = 2;
    session.contact_hold_s =
        0.3;  // with 50 ms a handle that oscillates loses longer contacts again and again
    RealRun run(session, kLockStep);
    ASSERT_EQ(run.end(), 0) << run.words();
    const auto rows = run.rows();
    std::set<std::tuple<Modality, double>> conditions;
    for (const TrialRow& row : rows) {
        conditions.insert({row.conditions.modality, row.conditions.delay_s});
        expect_on_disk(run, row);
        EXPECT_GE(row.delay_achieved_s, row.conditions.delay_s);  // a network may be late, never early
        EXPECT_GE(row.round_trip_s, row.delay_achieved_s);
    }
    EXPECT_EQ(rows.size(), 8U);
    EXPECT_EQ(conditions.size(), 8U);
    for (const char* program : kNodePrograms) {
        for (const int delay_ms : {0, 50}) {
            const auto report = run.report(program, delay_ms);
            expect_report(report, program);
            EXPECT_EQ(report.at("udp").at("send_failed"), 0) << program;
        }
    }
    const auto summary = nlohmann::json::parse(read_text(run.out() / "summary.json"));
    EXPECT_EQ(summary.at("clock"), "lock-step");
    EXPECT_GT(summary.at("simulated_s"), 10);
    EXPECT_EQ(whole_text(run.out() / "virtual.csv"), read_text(run.out() / "trials.csv"));
    EXPECT_THAT(read_text(run.out() / "report.html"), testing::HasSubstr("</html>"));
    EXPECT_THAT(nodes_alive(run.base_port()), testing::IsEmpty());
    const double deepest_prompt_m = row_of(rows, Modality::kHF, 0).metrics.penetration_max_m;
    EXPECT_LT(deepest_prompt_m, 0.005) << "HF without delay must settle";
    EXPECT_GT(row_of(rows, Modality::kHF, kDelay_s).metrics.penetration_max_m, deepest_prompt_m);
}

// The same trials, once over UDP and once in virtual time.
void expect_like_virtual_time(const std::vector<TrialRow>& rows, const std::filesystem::path& out) {
    const auto virtual_rows = read_trial_table(out / "virtual.csv");
    ASSERT_EQ(rows.size(), virtual_rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const TrialRow &real = rows[i], &other = virtual_rows[i];
        SCOPED_TRACE(to_string(real.conditions.modality));
        EXPECT_EQ(real.conditions.modality, other.conditions.modality);
        EXPECT_EQ(real.reason, other.reason);
        EXPECT_EQ(real.metrics.oscillates, other.metrics.oscillates);
        const double factor = real.metrics.penetration_max_m / other.metrics.penetration_max_m;
        EXPECT_GT(factor, 1 / 3.0);
        EXPECT_LT(factor, 3.0);
    }
}

// All processes share this machine's clock, so the truth is 0 and every exchange must contain it.
void expect_clocks_that_contain_the_truth(const std::filesystem::path& out) {
    std::map<Role, int> exchanges;
    for (const ClockRecord& record : read_clock_file(out / "nodes" / "clocks_0ms.csv")) {
        ++exchanges[record.node];
        EXPECT_LE(record.exchange.low(), Duration{}) << to_string(record.node);
        EXPECT_GE(record.exchange.high(), Duration{}) << to_string(record.node);
    }
    for (const Role node : kNodeRoles) EXPECT_GE(exchanges[node], 3) << to_string(node);
    const auto summary = nlohmann::json::parse(read_text(out / "summary.json"));
    EXPECT_THAT(summary["sections"].back().dump(), testing::HasSubstr("\"Clocks\""));
    EXPECT_THAT(summary["provenance"]["clock daemon"], testing::HasSubstr("chrony"));
}

TEST(WholeRun, AgreesWithVirtualTimeWithoutDelay) {
    SessionFile session;
    session.modalities = R"(["HF", "VF"])";
    session.contact_hold_s = 1.0;  // half of it is watched for oscillation
    RealRun run(session);
    ASSERT_EQ(run.end(), 0) << run.words();
    for (const char* program : kNodePrograms) {
        expect_report(run.report(program), program);
        EXPECT_GT(run.report(program).at("deadlines"), 0) << program;
    }
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 2U);
    expect_like_virtual_time(rows, run.out());
    for (const TrialRow& row : rows) EXPECT_FALSE(std::isnan(row.metrics.oscillation_rms_m));
    EXPECT_FALSE(rows[0].metrics.oscillates) << "HF without delay must settle";
    EXPECT_LT(rows[0].metrics.penetration_max_m, rows[1].metrics.penetration_max_m);
    expect_clocks_that_contain_the_truth(run.out());
}

}  // namespace
}  // namespace thimble
