// Verdicts from made-up figures: each rule, on both sides of its limit.
#include "thimble/link_test/link_report.hpp"

#include <cerrno>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stability/critical_delay.hpp"
#include "thimble/link_test/link_figures.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

SystemSettings paper() { return load_system_settings({}); }

SystemSettings config(const char* text) { return read_system_settings(ConfigFile::parse(text, "test")); }

LoopFigures link(double median_s, double p99_s) { return {true, median_s, p99_s, 0, 0.002}; }

Fit fit(Modality modality, const LoopFigures& figures) {
    return judge(modality, figures, loop_limits(paper())).fit;
}

TEST(LinkVerdict, LimitsFollowFromTheSession) {
    const LoopLimits limits = loop_limits(paper());
    EXPECT_NEAR(fixture_stiffness_N_per_m(paper().slave), 3000, 1e-6);
    // (b_grip + b_handle) / 9000 N/m is 2.2 ms; the arm adds a little.
    EXPECT_GT(limits.critical_delay_s, 0.0022);
    EXPECT_LT(limits.critical_delay_s, 0.0026);
    EXPECT_NEAR(limits.latency_s[1], 0.045 + 0.130, 1e-9);
    EXPECT_NEAR(limits.latency_s[2], 0.045 + 0.155 + 0.0026 + 0.020, 1e-9);
    EXPECT_NEAR(limits.latency_s[3], 0.5 / 60 + 0.025 + 0.240, 1e-9);
    EXPECT_DOUBLE_EQ(limits.needle_held_s, 0.020);
    EXPECT_DOUBLE_EQ(limits.released_s, 0.100);
}

TEST(LinkVerdict, ASofterFixtureBearsMoreAndNoneBearsAll) {
    EXPECT_GT(loop_limits(config("[fixture]\nstiffness_N_per_m = 1000\n")).critical_delay_s,
              2 * loop_limits(paper()).critical_delay_s);
    EXPECT_GT(loop_limits(config("[master]\nforce_scale = 0.5\n")).critical_delay_s,
              1.5 * loop_limits(paper()).critical_delay_s);
    const auto soft = config("[fixture]\nstiffness_N_per_m = 0\n");
    EXPECT_TRUE(std::isinf(loop_limits(soft).critical_delay_s));
    EXPECT_EQ(judge(Modality::kHF, link(0.05, 0.09), loop_limits(soft)).fit, Fit::kFits);
    // Damping of the fixture does not count as stiffness.
    EXPECT_NEAR(fixture_stiffness_N_per_m(config("[fixture]\ndamping_Ns_per_m = 100\n").slave), 3000, 1e-6);
    // An event that removes the fixture during the trial does not change its stiffness.
    const auto removed = config("[[fixture.event]]\nafter_contact_s = 5\npresent = false\n");
    EXPECT_NEAR(fixture_stiffness_N_per_m(removed.slave), 3000, 1e-6);
}

TEST(LinkVerdict, HandleForceNeedsAShortLoop) {
    const double critical_s = loop_limits(paper()).critical_delay_s - 0.0005;
    EXPECT_EQ(fit(Modality::kHF, link(0.0002, 0.99 * critical_s)), Fit::kFits);
    EXPECT_EQ(fit(Modality::kHF, link(0.0002, 1.01 * critical_s)), Fit::kMarginal);
    EXPECT_EQ(fit(Modality::kHF, link(1.01 * critical_s, 1.02 * critical_s)), Fit::kDoesNotFit);
    EXPECT_THAT(judge(Modality::kHF, link(0.05, 0.05), loop_limits(paper())).reason, HasSubstr("oscillates"));
}

TEST(LinkVerdict, AForceThatCountsAsTooOldIsToldWithTheKeyThatHelps) {
    const auto judged = [](const char* text, double median_s, double p99_s) {
        return judge(Modality::kHF, link(median_s, p99_s), loop_limits(config(text)));
    };
    const char* soft = "[fixture]\nstiffness_N_per_m = 0\n";
    EXPECT_EQ(judged(soft, 0.08, 0.09).fit, Fit::kFits);
    EXPECT_EQ(judged(soft, 0.08, 0.11).fit, Fit::kMarginal);
    EXPECT_EQ(judged(soft, 0.11, 0.11).fit, Fit::kDoesNotFit);
    EXPECT_THAT(judged(soft, 0.15, 0.2).reason, HasSubstr("oldest_force_s is 0.24"));
    EXPECT_EQ(judged("[master]\noldest_force_s = 0.24\n[fixture]\nstiffness_N_per_m = 0\n", 0.15, 0.2).fit,
              Fit::kFits);
    // The session's own delay is not the link's.
    EXPECT_EQ(judged("[netem.force]\ndelay_s = 0.3\n[fixture]\nstiffness_N_per_m = 0\n", 0.08, 0.09).fit,
              Fit::kFits);
}

TEST(LinkVerdict, TheOthersBearPartOfTheirOwnLatency) {
    const LoopLimits limits = loop_limits(paper());
    for (const Modality modality : {Modality::kCF, Modality::kCCF, Modality::kVF}) {
        const double own_s = limits.latency_s[static_cast<std::size_t>(modality)];
        EXPECT_EQ(fit(modality, link(0.001, 0.49 * own_s)), Fit::kFits);
        EXPECT_EQ(fit(modality, link(0.001, 0.51 * own_s)), Fit::kMarginal);
        EXPECT_EQ(fit(modality, link(0.001, 1.01 * own_s)), Fit::kDoesNotFit);
    }
    // The paper's 50 ms: what it found.
    EXPECT_EQ(fit(Modality::kHF, link(0.05, 0.05)), Fit::kDoesNotFit);
    for (const Modality modality : {Modality::kCF, Modality::kCCF, Modality::kVF})
        EXPECT_EQ(fit(modality, link(0.05, 0.05)), Fit::kFits);
}

TEST(LinkVerdict, PausesAndLossSpoilWhatDelayWouldAllow) {
    struct Case {
        Modality modality;
        double longest_gap_s, loss;
        Fit fit;
    };
    for (const Case& one :
         {Case{Modality::kCF, 0.019, 0, Fit::kFits}, Case{Modality::kCF, 0.021, 0, Fit::kMarginal},
          Case{Modality::kVF, 0.101, 0, Fit::kDoesNotFit}, Case{Modality::kHF, 0, 0.04, Fit::kFits},
          Case{Modality::kHF, 0, 0.06, Fit::kMarginal}, Case{Modality::kHF, 0, 0.5, Fit::kDoesNotFit}}) {
        EXPECT_EQ(fit(one.modality, {true, 0.0002, 0.0003, one.loss, one.longest_gap_s}), one.fit)
            << one.longest_gap_s << " " << one.loss;
    }
}

PortFigures port(Port which, PortAnswer answer) {
    PortFigures figures;
    figures.traffic = session_traffic()[static_cast<std::size_t>(which)];
    figures.answer = answer;
    figures.sent = figures.far_received = figures.far_sent = figures.returned =
        answer == PortAnswer::kAnswers ? 1000 : 0;
    figures.round_trip_median_s = figures.round_trip_p99_s = 0.0002;
    return figures;
}

TEST(LinkFigures, LossPerDirection) {
    PortFigures figures = port(Port::kSlaveNeedle, PortAnswer::kAnswers);
    EXPECT_EQ(figures.loss_there(), 0);
    EXPECT_EQ(figures.loss_back(), 0);
    figures.far_received = 900;
    figures.far_sent = 950;  // 50 copies made on the way there are echoed as well
    figures.returned = 720;
    figures.duplicates = 40;
    EXPECT_DOUBLE_EQ(figures.loss_there(), 0.1);
    EXPECT_DOUBLE_EQ(figures.loss_back(), 0.2);
    EXPECT_EQ(PortFigures{}.loss_there(), 0);
}

TEST(LinkFigures, TheWorstPortOfTheLoopCounts) {
    LinkFigures figures;
    figures.ports = {
        port(Port::kSlaveNeedle, PortAnswer::kAnswers), port(Port::kMasterForce, PortAnswer::kAnswers),
        port(Port::kMasterControl, PortAnswer::kAnswers), port(Port::kNetemNeedle, PortAnswer::kSilent)};
    figures.ports[1].round_trip_median_s = 0.003;
    figures.ports[1].returned = 900;
    figures.ports[2].round_trip_median_s = 1;  // no part of the loop
    figures.ports[2].longest_gap_s = 1;
    const LoopFigures loop = loop_figures(figures);
    EXPECT_TRUE(loop.measured);
    EXPECT_EQ(loop.round_trip_median_s, 0.003);
    EXPECT_DOUBLE_EQ(loop.loss, 0.1);
    EXPECT_EQ(loop.longest_gap_s, 0);
}

TEST(LinkReport, ExitCodes) {
    LinkReport report;
    report.link.ports = {port(Port::kSlaveNeedle, PortAnswer::kAnswers)};
    report.link.mtu.largest_bytes = 1472;
    const auto judged = [&] {
        report.verdicts = judge_all({Modality::kHF, Modality::kCF}, report.link, loop_limits(paper()));
        return exit_code(report);
    };
    EXPECT_EQ(judged(), ExitCode::kOk);
    report.link.ports[0].round_trip_median_s = report.link.ports[0].round_trip_p99_s = 0.05;
    EXPECT_EQ(judged(), ExitCode::kRunFailed);  // HF does not fit
    report.link.mtu.largest_bytes = 511;
    EXPECT_EQ(judged(), ExitCode::kNetwork);
    report.link.mtu.largest_bytes = 1472;
    report.link.ports.push_back(port(Port::kMasterForce, PortAnswer::kSilent));
    EXPECT_EQ(judged(), ExitCode::kNetwork);
    report.link.ports = {port(Port::kMasterControl, PortAnswer::kAnswers)};
    EXPECT_EQ(judged(), ExitCode::kOk);
    EXPECT_TRUE(report.verdicts.empty());
    EXPECT_THAT(to_text(report), HasSubstr("No verdict on any modality"));
}

TEST(LinkReport, TextAndJsonSayTheSame) {
    LinkReport report;
    report.link.host = "robot";
    report.link.base_port = 27000;
    report.link.ports = {port(Port::kSlaveNeedle, PortAnswer::kAnswers),
                         port(Port::kMasterForce, PortAnswer::kNobodyListens)};
    report.link.mtu = {1472, true};
    report.verdicts = judge_all({Modality::kHF}, report.link, loop_limits(paper()));
    const std::string text = to_text(report);
    EXPECT_THAT(text, HasSubstr("27014  slave_sim_needle"));
    EXPECT_THAT(text, HasSubstr("nobody listens at some ports"));
    EXPECT_THAT(text, HasSubstr("1472 bytes (MTU 1500, of this machine's interface)"));
    EXPECT_THAT(text, HasSubstr("HF  fits"));
    const auto written = to_json(report);
    EXPECT_EQ(written["ports"][1]["answer"], "nobody listens");
    EXPECT_EQ(written["largest_datagram_bytes"], 1472);
    EXPECT_EQ(written["modalities"][0]["verdict"], "fits");
    EXPECT_TRUE(written["clock"]["offset_s"].is_null());
    EXPECT_EQ(written["exit_code"], 3);
}

TEST(PortFinding, EachErrorHasItsMeaning) {
    EXPECT_EQ(classify({}), PortAnswer::kSilent);
    EXPECT_EQ(classify({1, ECONNREFUSED, true, 3}), PortAnswer::kAnswers);  // it came up while we knocked
    EXPECT_EQ(classify({0, ECONNREFUSED, true, 3}), PortAnswer::kNobodyListens);
    EXPECT_EQ(classify({0, ENETUNREACH}), PortAnswer::kNoRoute);
    EXPECT_EQ(classify({0, EHOSTUNREACH, true, 1}), PortAnswer::kNoRoute);
    EXPECT_EQ(classify({0, EPERM}), PortAnswer::kProhibited);
    EXPECT_EQ(classify({0, EACCES}), PortAnswer::kProhibited);
    // Linux tells "administratively prohibited" as host or net unreachable: ICMP's code knows better.
    for (const int code : {9, 10, 13}) {
        EXPECT_EQ(classify({0, EHOSTUNREACH, true, code}), PortAnswer::kProhibited);
        EXPECT_EQ(classify({0, EHOSTUNREACH, false, code}), PortAnswer::kNoRoute);
    }
}

TEST(PortFinding, TheHostIsJudgedByAllItsPorts) {
    using P = PortAnswer;
    const auto said = [](const std::vector<P>& ports) { return diagnose(ports, "robot", 27000); };
    EXPECT_EQ(said({P::kAnswers, P::kAnswers}), "");
    EXPECT_THAT(said({P::kSilent, P::kSilent}), HasSubstr("down, or a firewall drops everything"));
    EXPECT_THAT(said({P::kSilent, P::kAnswers}), HasSubstr("a firewall may block them"));
    EXPECT_THAT(said({P::kSilent, P::kNobodyListens}), HasSubstr("a firewall may block them"));
    EXPECT_THAT(said({P::kNobodyListens, P::kNobodyListens}), HasSubstr("--listen --base-port 27000"));
    EXPECT_THAT(said({P::kNobodyListens, P::kAnswers}), HasSubstr("nobody listens at some ports"));
    EXPECT_THAT(said({P::kNoRoute, P::kNoRoute}), HasSubstr("no route to robot"));
    EXPECT_THAT(said({P::kAnswers, P::kProhibited}), HasSubstr("a firewall rejects the datagrams"));
}

}  // namespace
}  // namespace thimble
