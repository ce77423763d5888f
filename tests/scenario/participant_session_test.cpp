// A participant's session in virtual time: the whole haptic loop, and the subject's key.
#include "session/participant/participant_session.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "session/participant/dataset.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble::test {
namespace {

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

TEST(VirtualParticipantSession, TheSubjectsKeyMovesItOn) {
    SystemSettings settings = read_system_settings(ConfigFile::parse(
        "[session]\nmodalities = ['HF', 'CF', 'VF']\n[protocol]\nexperiments = [1, 2]\nsubjects = 3\n"
        "trials_per_modality = 1\nremovals = 1\npractice_trials = 1\nbreak_every = 2\n"
        "[fixture]\nposition_m = 0.04\n[trial]\ncontact_hold_s = 0.5\n",
        "session.toml"));
    settings.protocol->break_minimum = std::chrono::seconds{5};
    settings.visual.subject_goes_on = settings.session.subject_goes_on = true;
    const TemporaryDirectory directory;
    const Dataset folder(directory / "pressed");
    folder.open(SubjectKind::kVirtual, settings.dataset);
    write_order(folder.order(2), plan_order(settings, 2));
    PressedTrials trials(settings);
    ParticipantSessionOptions options{folder, 2,       *settings.protocol,       nullptr,
                                      true,   nullptr, [](const std::string&) {}};
    options.subject_goes_on = true;
    EXPECT_EQ(ParticipantSession(std::move(options), trials).run().code, ExitCode::kOk);
    using enum PageKind;
    EXPECT_EQ(trials.pages, (std::vector{kWelcome, kBreak, kReady, kReady, kBreak, kReady, kReady}));
    EXPECT_EQ(read_records(folder.records(2)).size(), 5U);
    EXPECT_EQ(trials.refused(), 0U) << "a key that can do nothing is not even said";
    EXPECT_GE(trials.shortest_read, std::chrono::seconds{1})
        << "a key pressed in a break is not kept for its end";
}

}  // namespace
}  // namespace thimble::test
