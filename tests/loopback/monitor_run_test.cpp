// `thimble run --monitor`: a view watches, and sends the orders that a participant session knows.
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "session/participant/dataset.hpp"
#include "session/participant/record_table.hpp"
#include "tests/loopback/played_view.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

Order order_of(OrderKind kind, std::uint32_t trial = 0) {
    Order order;
    order.kind = kind;
    order.trial = trial;
    return order;
}

bool watch(PlayedView& view, const std::function<bool()>& done) {
    return wait_until([&] {
        view.listen(wall_now());
        return done();
    });
}

TEST(MonitorOfARun, ShowsTheTrialAndTakesQuit) {
    RealRun run(SessionFile::endless(), {"--monitor"});
    PlayedView view(run.base_port());
    ASSERT_TRUE(watch(view, [&] { return view.monitor().phase == TissuePhase::kPenetrated; })) << run.words();
    EXPECT_TRUE(view.running());
    EXPECT_EQ(view.monitor().position_fixture_m, 0.035);
    EXPECT_GT(view.monitor().accepted, 100U);
    EXPECT_TRUE(watch(view, [&] { return view.monitor().one_way_s >= 0; }));
    Order delay = order_of(OrderKind::kDelay);
    delay.value = 0.4;  // a condition of the trial: refused
    view.order(wall_now(), delay);
    view.order(wall_now(), order_of(OrderKind::kQuit));
    EXPECT_EQ(run.end(), 1);
    EXPECT_EQ(view.monitor().network_delay_s, 0);
    EXPECT_EQ(run.only_reason(), EndReason::kInterrupted);
}

TEST(MonitorOfARun, WithoutItNobodyListens) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    EXPECT_NO_THROW(UdpChannel(network_at(run.base_port()).at(Port::kSessionOrders), {"127.0.0.1", 0}));
    run.launcher().signal(SIGTERM);
    run.end();
}

TEST(MonitorOfAParticipantSession, ATrialIsRepeatedWhenTheViewAsks) {
    const Folder folder;
    const PortBlock ports;
    const auto file =
        folder.write("session.toml",
                     "[session]\nsubject = 7\nmodalities = ['HF', 'CF']\nfixture_jitter_m = 0\n"
                     "[fixture]\nposition_m = 0.035\n[trial]\ncontact_hold_s = 0.2\n[protocol]\n"
                     "experiments = [1]\ntrials_per_modality = 1\npractice_trials = 0\n");
    Child child(built_programs() / "thimble",
                {"run", file.string(), "--out", (folder / "data").string(), "--base-port",
                 std::to_string(ports.base()), "--monitor"},
                folder / "words");
    PlayedView view(ports.base());
    ASSERT_TRUE(watch(view, [&] { return view.running(); })) << read_text(folder / "words");
    EXPECT_EQ(view.monitor().trials, 2U);
    view.order(wall_now(), order_of(OrderKind::kRepeat, view.trial()));
    view.order(wall_now(), order_of(OrderKind::kRepeat, view.trial()));  // said again
    EXPECT_TRUE(watch(view, [&] { return child.poll().has_value(); }));
    EXPECT_EQ(child.wait(kPatience).value_or(-1), 0) << read_text(folder / "words");
    const auto records = read_records(Dataset(folder / "data").records(7));
    ASSERT_EQ(records.size(), 3U) << read_text(folder / "words");
    EXPECT_EQ(records[2].position, records[0].position);
    EXPECT_NE(records[2].repeat_of, 0U);
}

}  // namespace
}  // namespace thimble
