// Trials by the real programs over UDP, in real time.
#pragma once

#include <atomic>
#include <optional>

#include "common/process/progress.hpp"
#include "session/participant/participant_session.hpp"
#include "session/run/condition_run.hpp"

namespace thimble {

class RealTrials final : public TrialRunner {
  public:
    // `plan.out`: each start of the programs gets a folder of its own in it.
    RealTrials(ConditionPlan plan, const std::atomic<bool>* stop);

    void prepare() override;
    std::uint32_t last_number() const override { return condition_ ? condition_->last_number() : 0; }
    TrialRecord run(const TrialConditions& conditions, std::uint32_t number,
                    const std::filesystem::path& trajectory) override;
    void show(const Page& page) override;
    bool take_go_on() override { return condition_ && condition_->take_go_on(); }
    void idle(Duration limit) override;
    SessionTime now() const override;
    std::string problem() const override { return problem_; }
    std::string stop_text() const override;
    void release_stop() override;

    void say(const std::string& line) { progress_.say(line); }
    // Ends the programs. Not ok with ExitCode::kRealtime, if one missed too many deadlines under strict_rt.
    ConditionResult close();

  private:
    ConditionPlan plan_;
    std::filesystem::path nodes_;
    ConditionEvents events_;
    Progress progress_;
    std::optional<ConditionRun> condition_;
    std::string problem_;
};

}  // namespace thimble
