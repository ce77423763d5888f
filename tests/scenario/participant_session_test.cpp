// A participant's session in virtual time: the whole haptic loop, the tables of a dataset, a power cut.
#include "session/participant/participant_session.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "session/participant/counted_trials.hpp"
#include "session/participant/dataset.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble::test {
namespace {

struct PowerCut {};

class VirtualTrials final : public TrialRunner {
  public:
    explicit VirtualTrials(const SystemSettings& settings) : settings_(settings) {}

    void prepare() override {}
    std::uint32_t last_number() const override { return 0; }
    TrialRecord run(const TrialConditions& conditions, std::uint32_t /*number*/,
                    const std::filesystem::path& /*trajectory*/) override {
        if (left_ == 0) throw PowerCut();
        --left_;
        return run_virtual_trial(settings_, conditions);
    }
    void show(const Page& /*page*/) override {}
    bool take_go_on() override { return false; }
    void idle(Duration limit) override { now_ += limit; }
    SessionTime now() const override { return now_; }
    std::string problem() const override { return {}; }
    void cut_after(std::size_t trials) { left_ = trials; }

  private:
    SystemSettings settings_;
    std::size_t left_ = 1000;
    SessionTime now_{};
};

class VirtualParticipantSession : public testing::Test {
  protected:
    void use(const std::string& more) {
        settings_ = read_system_settings(ConfigFile::parse(
            "[session]\nmodalities = ['HF', 'CF', 'VF']\n[protocol]\nexperiments = [1, 2]\nsubjects = 3\n"
            "trials_per_modality = 1\nremovals = 1\npractice_trials = 1\nbreak_every = 2\n"
            "[fixture]\nposition_m = 0.04\n" +
                more,
            "session.toml"));
    }
    Dataset dataset(const std::string& name) const {
        Dataset dataset(directory_ / name);
        dataset.open(SubjectKind::kVirtual, settings_.dataset);
        add_participant(dataset, 2, SubjectKind::kVirtual, {});
        write_order(dataset.order(2), plan_order(settings_, 2));
        return dataset;
    }
    ParticipantSessionResult run_to_end(const Dataset& dataset, VirtualTrials& trials) const {
        ParticipantSessionOptions options{dataset, 2,       *settings_.protocol,      nullptr,
                                          false,   nullptr, [](const std::string&) {}};
        return ParticipantSession(std::move(options), trials).run();
    }

    TemporaryDirectory directory_;
    SystemSettings settings_;
};

TEST_F(VirtualParticipantSession, APowerCutCostsTheRunningTrialOnly) {
    use("[trial]\ncontact_hold_s = 1\n");
    const Dataset whole = dataset("whole");
    VirtualTrials trials(settings_);
    EXPECT_EQ(run_to_end(whole, trials).code, ExitCode::kOk);
    const Dataset cut = dataset("cut");
    for (int start = 0; start < 10; ++start) {
        trials.cut_after(1);
        try {
            if (run_to_end(cut, trials).code == ExitCode::kOk) break;
        } catch (const PowerCut&) {
        }
    }
    EXPECT_EQ(read_text(cut.records(2)), read_text(whole.records(2)));
    const CountedTrials counted = counted_trials(whole);
    EXPECT_EQ(counted.rows.size(), 4U);  // three modalities and a removal
    EXPECT_EQ(counted.missing, 0U);
    for (const TrialRow& row : counted.rows) {
        EXPECT_TRUE(row.metrics.beeped);
        EXPECT_EQ(std::isnan(row.metrics.peak_displacement_m), !row.conditions.removes_fixture);
    }
}

// No trial gets to the beep in a second and a half, so every trial but practice is repeated as often as allowed.
TEST_F(VirtualParticipantSession, TimeoutsAreRepeatedAndTheLastOneCounts) {
    use("[trial]\ntimeout_s = 1.5\n");
    settings_.protocol->repeats_limit = 2;
    const Dataset timed_out = dataset("timed_out");
    VirtualTrials trials(settings_);
    const ParticipantSessionResult result = run_to_end(timed_out, trials);
    EXPECT_EQ(result.code, ExitCode::kOk);
    EXPECT_EQ(result.records, 1U + 4 * 3);
    const auto records = read_records(timed_out.records(2));
    for (const DatasetRecord& record : records) EXPECT_EQ(record.row.reason, EndReason::kTimeout);
    const CountedTrials counted = counted_trials(timed_out);
    EXPECT_EQ(counted.rows.size(), 4U);
    EXPECT_EQ(counted.left_out.size(), records.size() - 4);
}

// One set of nodes for the whole session, as in real time, and a participant who reads each page for a second and presses.
class PressedTrials final : public TrialRunner {
  public:
    explicit PressedTrials(const SystemSettings& settings) : rig_(settings) {}

    void prepare() override {}
    std::uint32_t last_number() const override { return rig_.session().last_number(); }
    TrialRecord run(const TrialConditions& conditions, std::uint32_t number,
                    const std::filesystem::path& /*trajectory*/) override {
        shortest_read = std::min(shortest_read, rig_.now() - since_);
        rig_.session().start(conditions, number);
        rig_.idle(std::chrono::milliseconds{50});
        rig_.press_key();  // in a trial, where there is nothing to go on from
        return rig_.finish();
    }
    void show(const Page& page) override { rig_.session().show(page); }
    bool take_go_on() override { return rig_.session().take_go_on(); }
    void idle(Duration limit) override {
        rig_.idle(limit);
        if (rig_.page().kind != read_.kind || rig_.page().trial != read_.trial) {
            read_ = rig_.page();
            since_ = rig_.now();
            if (read_.kind != PageKind::kNone) pages.push_back(read_.kind);
        }
        if (rig_.now() - since_ >= std::chrono::seconds{1}) rig_.press_key();
    }
    SessionTime now() const override { return rig_.now(); }
    std::string problem() const override { return {}; }

    std::vector<PageKind> pages;
    Duration shortest_read = Duration::max();
    std::uint64_t refused() { return rig_.session().peer(Role::kVisual).counters().refused_total(); }

  private:
    mutable Rig rig_;  // tells of its session by a way in
    Page read_;
    SessionTime since_{};
};

ParticipantSessionResult sit_with_key(const Dataset& dataset, const SystemSettings& settings,
                                      PressedTrials& trials) {
    ParticipantSessionOptions options{dataset, 2,       *settings.protocol,       nullptr,
                                      true,    nullptr, [](const std::string&) {}};
    options.subject_goes_on = true;
    return ParticipantSession(std::move(options), trials).run();
}

TEST_F(VirtualParticipantSession, TheSubjectsKeyMovesItOn) {
    use("[trial]\ncontact_hold_s = 0.5\n");
    settings_.protocol->break_minimum = std::chrono::seconds{5};
    settings_.visual.subject_goes_on = settings_.session.subject_goes_on = true;
    const Dataset folder = dataset("pressed");
    PressedTrials trials(settings_);
    EXPECT_EQ(sit_with_key(folder, settings_, trials).code, ExitCode::kOk);
    using enum PageKind;
    EXPECT_EQ(trials.pages, (std::vector{kWelcome, kBreak, kReady, kReady, kBreak, kReady, kReady}));
    EXPECT_EQ(read_records(folder.records(2)).size(), 5U);
    EXPECT_EQ(trials.refused(), 0U) << "a key that can do nothing is not even said";
    EXPECT_GE(trials.shortest_read, std::chrono::seconds{1})
        << "a key pressed in a break is not kept for its end";
}

// The session alone, and a test that speaks as visual_node.
class RequestTest : public testing::Test {
  protected:
    // Whether it is heard; if not, it is counted.
    bool request(PageKind kind, OrderKind order, std::uint32_t trial = 0) {
        Page page;
        page.kind = kind;
        session_.show(page);
        const std::uint64_t before = session_.peer(Role::kVisual).counters().refused_total();
        Order wished;
        wished.kind = order;
        visual_.send(now_ += std::chrono::milliseconds{1}, trial, wished);
        session_.tick(now_);
        const bool heard = session_.take_go_on();
        EXPECT_EQ(session_.peer(Role::kVisual).counters().refused_total() - before, heard ? 0U : 1U);
        return heard;
    }
    static SessionSettings settings() {
        SessionSettings settings;
        settings.subject_goes_on = true;
        return settings;
    }

    std::array<QueuePipe, kNodeRoles.size()> control_;  // a: session
    QueuePipe record_;
    SessionTime now_{std::chrono::seconds{1}};
    SessionProcess session_{
        1,
        settings(),
        {{&control_[0].a, &control_[1].a, &control_[2].a, &control_[3].a, &control_[4].a}, &record_.b}};
    OutboundFlow visual_{Role::kVisual, 2, {&control_[3].b}};
};

TEST_F(RequestTest, IsHeardWhereAPageWaitsForIt) {
    for (const PageKind waits : {PageKind::kWelcome, PageKind::kPractice, PageKind::kReady})
        EXPECT_TRUE(request(waits, OrderKind::kResume));
    for (const PageKind rests : {PageKind::kBreak, PageKind::kPaused, PageKind::kDone, PageKind::kWait})
        EXPECT_FALSE(request(rests, OrderKind::kResume));
    EXPECT_FALSE(request(PageKind::kReady, OrderKind::kResume, 7)) << "asked for another trial";
}

TEST_F(RequestTest, NoOtherOrderIs) {
    for (int kind = 0; kind <= static_cast<int>(OrderKind::kSpeed); ++kind) {
        const auto other = static_cast<OrderKind>(kind);
        EXPECT_EQ(request(PageKind::kReady, other), other == OrderKind::kResume) << kind;
    }
}

TEST_F(RequestTest, IsOfThePageOnWhichItWasSaid) {
    Page page;
    page.kind = PageKind::kReady;
    page.trial = 3;
    session_.show(page);
    Order wished;
    wished.kind = OrderKind::kResume;
    visual_.send(now_, 0, wished);
    session_.tick(now_);
    page.trial = 4;
    session_.show(page);
    EXPECT_FALSE(session_.take_go_on());
}

}  // namespace
}  // namespace thimble::test
