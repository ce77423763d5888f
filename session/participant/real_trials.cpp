#include "session/participant/real_trials.hpp"

#include <utility>

#include <fmt/format.h>

#include "common/runtime/wall_clock.hpp"
#include "session/records/condition_summary.hpp"

namespace thimble {
namespace {

// The logs of an earlier start stay.
std::filesystem::path next_start(const std::filesystem::path& nodes) {
    std::error_code absent;
    unsigned start = 1;
    while (std::filesystem::exists(nodes / fmt::format("start{:02}", start), absent)) ++start;
    return nodes / fmt::format("start{:02}", start);
}

}  // namespace

RealTrials::RealTrials(ConditionPlan plan, const std::atomic<bool>* stop)
    : plan_(std::move(plan)), nodes_(plan_.out) {
    events_.stop = [stop] { return stop != nullptr && *stop; };
    events_.progress = [this](const TrialConditions& c, const TrajectorySample& s) {
        progress_.show(fmt::format("{} {}: {:.1f} s, needle {:.1f} mm, force {:.2f} N, contact {:.1f} s",
                                   delay_text(c.delay_s), to_string(c.modality), s.time_s,
                                   1000 * s.position_needle_m, s.force_total_N, s.contact_time_s),
                       false);
    };
}

void RealTrials::prepare() {
    if (condition_ && !condition_->broken()) return;
    if (condition_ && plan_.starter && condition_->revive()) return;
    if (condition_) condition_->close();
    const std::string stopped = stop_text();
    condition_.reset();
    plan_.out = next_start(nodes_);
    plan_.holds_stop = !stopped.empty();
    condition_.emplace(plan_, events_);
    condition_->open();
    // A stop outlives the programs that knew of it.
    if (!stopped.empty()) condition_->emergency_stop("stopped before all programs were started anew");
}

std::string RealTrials::stop_text() const { return condition_ ? condition_->stop_text() : std::string(); }

void RealTrials::release_stop() {
    if (condition_) condition_->release_stop();
}

TrialRecord RealTrials::run(const TrialConditions& conditions, std::uint32_t number,
                            const std::filesystem::path& trajectory) {
    TrialRecord record = condition_->run_trial(conditions, number, trajectory);
    problem_ = condition_->result().problem;
    return record;
}

void RealTrials::show(const Page& page) {
    if (condition_) condition_->show(page);
}

void RealTrials::idle(Duration limit) {
    if (!condition_) return wall_sleep(limit);
    // A participant who is to go on needs the window that asks.
    if (plan_.starter && condition_->broken() && !events_.stop()) {
        say("a program has ended: it is started anew");
        prepare();
    }
    condition_->idle(limit);
}

SessionTime RealTrials::now() const { return wall_now(); }

ConditionResult RealTrials::close() {
    ConditionResult result;
    if (condition_) result = condition_->close();
    condition_.reset();
    return result;
}

}  // namespace thimble
