// A participant's sitting in virtual time: the whole haptic loop, the tables of a dataset, a power cut.
#include "experiment/sitting/sitting.hpp"

#include <gtest/gtest.h>

#include "experiment/sitting/counted_trials.hpp"
#include "experiment/sitting/participants_table.hpp"
#include "experiment/virtual_session.hpp"
#include "tests/unit/experiment/records.hpp"

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

class VirtualSitting : public testing::Test {
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
    SittingResult sit(const Dataset& dataset, VirtualTrials& trials) const {
        SittingOptions options{dataset, 2,       *settings_.protocol,      nullptr,
                               false,   nullptr, [](const std::string&) {}};
        return Sitting(std::move(options), trials).run();
    }

    TemporaryDirectory directory_;
    SystemSettings settings_;
};

TEST_F(VirtualSitting, APowerCutCostsTheRunningTrialOnly) {
    use("[trial]\ncontact_hold_s = 1\n");
    const Dataset whole = dataset("whole");
    VirtualTrials trials(settings_);
    EXPECT_EQ(sit(whole, trials).code, ExitCode::kOk);
    const Dataset cut = dataset("cut");
    for (int start = 0; start < 10; ++start) {
        trials.cut_after(1);
        try {
            if (sit(cut, trials).code == ExitCode::kOk) break;
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

// Nobody gets to the beep in a second and a half: every trial but practice is repeated as often as allowed.
TEST_F(VirtualSitting, TimeoutsAreRepeatedAndTheLastOneCounts) {
    use("[trial]\ntimeout_s = 1.5\n");
    settings_.protocol->repeats_limit = 2;
    const Dataset timed_out = dataset("timed_out");
    VirtualTrials trials(settings_);
    const SittingResult result = sit(timed_out, trials);
    EXPECT_EQ(result.code, ExitCode::kOk);
    EXPECT_EQ(result.records, 1U + 4 * 3);
    const auto records = read_records(timed_out.records(2));
    for (const SittingRecord& record : records) EXPECT_EQ(record.row.reason, EndReason::kTimeout);
    const CountedTrials counted = counted_trials(timed_out);
    EXPECT_EQ(counted.rows.size(), 4U);
    EXPECT_EQ(counted.left_out.size(), records.size() - 4);
}

}  // namespace
}  // namespace thimble::test
