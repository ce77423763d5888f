// Trials by the real programs over UDP, in real time.
#pragma once

#include <atomic>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "common/process/progress.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/participant/participant_session.hpp"
#include "session/records/condition_summary.hpp"
#include "session/run/condition_run.hpp"

namespace thimble {

// The logs of an earlier start stay.
inline std::filesystem::path next_start(const std::filesystem::path& nodes) {
    std::error_code absent;
    unsigned start = 1;
    while (std::filesystem::exists(nodes / fmt::format("start{:02}", start), absent)) ++start;
    return nodes / fmt::format("start{:02}", start);
}

class RealTrials final : public TrialRunner {
  public:
    // `plan.out`: each start of the programs gets a folder of its own in it.
    // `blinded`: what is said of a running trial names neither modality nor delay, and no force.
    RealTrials(ConditionPlan plan, const std::atomic<bool>* stop, bool blinded = false)
        : plan_(std::move(plan)), nodes_(plan_.out) {
        events_.stop = [stop] { return stop != nullptr && *stop; };
        events_.progress = [this, blinded](const TrialConditions& c, const TrajectorySample& s) {
            if (blinded) return progress_.show(fmt::format("{:.1f} s", s.time_s), false);
            progress_.show(fmt::format("{} {}: {:.1f} s, needle {:.1f} mm, force {:.2f} N, contact {:.1f} s",
                                       delay_text(c.delay_s), to_string(c.modality), s.time_s,
                                       1000 * s.position_needle_m, s.force_total_N, s.contact_time_s),
                           false);
        };
    }

    void prepare() override {
        if (condition_ && !condition_->broken()) return;
        if (condition_ && plan_.starter && condition_->revive()) return;
        if (condition_) tell_loss(condition_->close());
        const std::string stopped = stop_text();
        condition_.reset();
        plan_.out = next_start(nodes_);
        plan_.holds_stop = !stopped.empty();
        condition_.emplace(plan_, events_);
        condition_->open();
        // A stop stays active when the programs that knew it have ended.
        if (!stopped.empty()) condition_->emergency_stop("stopped before all programs had restarted");
    }

    std::uint32_t last_number() const override { return condition_ ? condition_->last_number() : 0; }
    TrialRecord run(const TrialConditions& conditions, std::uint32_t number,
                    const std::filesystem::path& trajectory) override {
        TrialRecord record = condition_->run_trial(conditions, number, trajectory);
        problem_ = condition_->result().problem;
        return record;
    }

    void show(const Page& page) override {
        if (condition_) condition_->show(page);
    }

    bool take_go_on() override { return condition_ && condition_->take_go_on(); }
    std::optional<double> take_answer() override {
        return condition_ ? condition_->take_answer() : std::nullopt;
    }
    void idle(Duration limit) override {
        if (!condition_) return wall_sleep(limit);
        // A participant who is to go on needs the window that asks.
        if (plan_.starter && condition_->broken() && !events_.stop()) {
            say("a program has ended: restarting it");
            prepare();
        }
        condition_->idle(limit);
    }

    SessionTime now() const override { return wall_now(); }
    std::string problem() const override { return problem_; }
    std::string stop_text() const override { return condition_ ? condition_->stop_text() : std::string(); }
    void release_stop() override {
        if (condition_) condition_->release_stop();
    }

    void say(const std::string& line) { progress_.say(line); }
    // Ends the programs. The code is kRealtime if one missed too many deadlines under strict_rt. It is kRunFailed if data are
    // lost, a plug-in hangs at its end, or a stop holds.
    ConditionResult close() {
        ConditionResult result;
        if (condition_) result = condition_->close();
        condition_.reset();
        return result;
    }

  private:
    void tell_loss(const ConditionResult& closed) {
        if (!closed.write_fault.empty() && closed.write_fault != problem_)
            say("warning: " + closed.write_fault);
    }

    ConditionPlan plan_;
    std::filesystem::path nodes_;
    ConditionEvents events_;
    Progress progress_;
    std::optional<ConditionRun> condition_;
    std::string problem_;
};

}  // namespace thimble
