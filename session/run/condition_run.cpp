#include "session/run/condition_run.hpp"

#include <algorithm>

#include "common/runtime/node_report.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/version.hpp"

namespace thimble {
namespace {

constexpr Duration kPoll = std::chrono::milliseconds{20};   // look after children, stop requests
constexpr Duration kFlush = std::chrono::milliseconds{80};  // trajectory to the thread that writes it
constexpr Duration kProgress = std::chrono::milliseconds{500};
constexpr Duration kWordsAfter = std::chrono::milliseconds{500};  // of a node that waits for its user

Sockets open_sockets(const ConditionPlan& plan, MessageLog* log) {
    Sockets sockets(plan.network);
    if (log != nullptr) sockets.record_to(*log, plan.log.messages == LoggedMessages::kAll);
    return sockets;
}

// The session's own, as the nodes write theirs.
nlohmann::ordered_json session_report(const Sockets& sockets, bool realtime) {
    const UdpCounters udp = sockets.counters();
    return {{"program", "thimble"},
            {"version", kVersion},
            {"realtime_scheduling", realtime},
            {"udp",
             {{"sent", udp.sent},
              {"received", udp.received},
              {"send_failed", udp.send_failed},
              {"foreign_source", udp.foreign_source},
              {"too_long", udp.too_long}}},
            {"security", describe_security(sockets)}};
}

}  // namespace

void ConditionRun::SessionAndObserver::tick(SessionTime now) {
    if (security_ != nullptr) security_->tick(now);
    session_->tick(now);
    if (observer_) observer_->tick(now);
    if (security_ != nullptr) security_->tick(now);
}

SessionTime ConditionRun::SessionAndObserver::next_wakeup() const {
    SessionTime next = session_->next_wakeup();
    if (security_ != nullptr) next = std::min(next, security_->next_wakeup());
    return observer_ ? std::min(next, observer_->next_wakeup()) : next;
}

ConditionRun::ConditionRun(const ConditionPlan& plan, const ConditionEvents& events)
    : plan_(plan),
      events_(events),
      realtime_(plan.runtime),
      files_(plan),
      sockets_(open_sockets(plan, files_.log())),
      session_(system_entropy(), plan.session, sockets_),
      both_(session_, plan.make_observer ? plan.make_observer(session_, sockets_, plan.name) : nullptr,
            sockets_.security()),
      loop_(sockets_.listeners()),
      nodes_(plan, files_),
      stop_(session_, plan),
      outcome_(files_, nodes_, stop_) {
    session_.set_sample_hook([this](const TrajectorySample& sample) {
        last_ = sample;
        files_.add(sample);
    });
    session_.set_clock_hook([this](Role node, const ClockExchange& exchange) {
        files_.add(node, exchange, session_.clock_of(node));
    });
}

void ConditionRun::open() {
    if (!plan_.holds_stop) stop_.require_released();
    files_.open();
    if (plan_.starter) nodes_.launch();
    nodes_.wait_for_machines([this] { turn_before_trials(); });
    wait_for_nodes();
}

void ConditionRun::turn(SessionTime until) {
    loop_.step(both_, until);
    stop_.look();
    files_.flush();
}

void ConditionRun::check() {
    // A closed window is no dead program.
    if (nodes_.dead() && !interrupted()) nodes_.throw_if_dead();
}

void ConditionRun::turn_before_trials() {
    turn(wall_now() + kPoll);
    check();
    if (interrupted()) throw Error(ExitCode::kRunFailed, "interrupted before the first trial");
}

void ConditionRun::wait_for_nodes() {
    const SessionTime begin = wall_now();
    const Duration limit = plan_.session.peer_wait + plan_.session.user_limit;
    SessionTime next_words = begin + kWordsAfter;
    for (SessionTime now = begin; !session_.missing_peers(now, kPeerTimeout).empty(); now = wall_now()) {
        turn_before_trials();
        // The user may have to make the handle ready first. The master's log says how.
        if (plan_.session.user_limit > Duration::zero() && now > next_words) {
            next_words = now + kWordsAfter;
            nodes_.pass_on_messages();
        }
        if (now < begin + limit) continue;
        throw Error(ExitCode::kNetwork,
                    "no answer from {} within {} s on ports from {}{}: see the logs in {}",
                    session_.missing_peers(now, kPeerTimeout), to_seconds(limit), plan_.network.base_port,
                    why_silent(), plan_.out.string());
    }
}

// The reason for silence, if it is a wrong lab key.
std::string ConditionRun::why_silent() const {
    const std::string complaint = sockets_.security() == nullptr ? "" : sockets_.security()->complaint();
    return complaint.empty() ? complaint : " (" + complaint + ")";
}

// A new program knows no trial: an old order, which has an older number, starts nothing.
bool ConditionRun::revive() {
    if (!nodes_.restart_dead()) return false;
    outcome_.forget();
    nodes_.wait_for_machines([this] { turn_before_trials(); });
    // The session heard the old programs a moment ago. It hears the new ones only after a second of silence.
    const SessionTime forgotten = wall_now() + 2 * kPeerTimeout;
    for (SessionTime now = wall_now(); now < forgotten && session_.missing_peers(now, kPeerTimeout).empty();
         now = wall_now()) {
        turn(now + kPoll);
    }
    wait_for_nodes();
    return true;
}

void ConditionRun::emergency_stop(std::string_view words) { session_.emergency_stop(wall_now(), words); }
void ConditionRun::release_stop() { session_.release_stop(wall_now()); }

const TrialRecord& ConditionRun::run_trial(const TrialConditions& trial, std::uint32_t number,
                                           const std::filesystem::path& trajectory) {
    files_.begin_trial(trial, number, trajectory);
    outcome_.begin_trial();
    session_.start(trial, number);
    const SessionTime begin = wall_now();
    SessionTime next_poll{}, next_flush{}, next_progress{};
    while (!session_.finished()) {
        const SessionTime now = wall_now();
        loop_.step(both_, now + kPoll);
        if (now >= next_poll) {
            next_poll = now + kPoll;
            look_around();
        }
        if (now >= next_flush) {
            next_flush = now + kFlush;
            files_.flush();
        }
        if (now >= next_progress && events_.progress) {
            events_.progress(trial, last_);
            next_progress = now + kProgress;
        }
    }
    outcome_.result().simulated_s += to_seconds(wall_now() - begin);
    close_trial();
    return session_.record();
}

void ConditionRun::look_around() {
    // The order matters: a closed window is no dead program, and an interruption may follow from a stop.
    const auto dead = nodes_.dead();
    const bool told_to_end = interrupted();
    stop_.look();
    if (told_to_end) return session_.abort(EndReason::kInterrupted);
    const bool cannot_write = !files_.fault().empty() || !files_.log_fault().empty();
    if (cannot_write) return session_.abort(EndReason::kDeviceFault, Role::kSession);
    if (dead) session_.abort(EndReason::kPeerLost, kNodeRoles[*dead]);
}

void ConditionRun::close_trial() {
    const TrialRecord& record = session_.record();
    files_.end_trial(record);
    outcome_.judge(record, interrupted());
    const bool changed = session_.delay_s() != to_seconds(plan_.session.force_delay);
    if (!plan_.starter && !changed) outcome_.judge_delay(record, plan_.session.least_force_delay);
    if (events_.trial_done) events_.trial_done(record);
}

void ConditionRun::idle(Duration limit) {
    const SessionTime end = wall_now() + limit;
    for (SessionTime now = wall_now(); now < end; now = wall_now()) {
        turn(std::min(end, now + kPoll));
        nodes_.dead();
    }
}

ConditionResult ConditionRun::close() {
    stop_.look();
    ConditionResult& result = outcome_.result();
    result.clocks = files_.close_clocks();
    if (plan_.starter) {
        session_.shut_down(wall_now());
        nodes_.end(result);
    }
    // A stop that comes while the nodes end still holds for the next session.
    both_.tick(wall_now());
    stop_.look();
    outcome_.add_last_stop();
    result.reports.push_back(session_report(sockets_, realtime_.granted()));
    files_.write_session_report(result.reports.back());
    outcome_.add_write_fault(files_.fault());
    if (files_.log() != nullptr) outcome_.add_write_fault(files_.log()->close().fault);
    for (const auto& report : result.reports) outcome_.add_write_fault(log_fault_in(report));
    return std::move(result);
}

ConditionResult run_condition(const ConditionPlan& plan, const ConditionEvents& events) {
    ConditionRun condition(plan, events);
    condition.open();
    for (const TrialConditions& trial : plan.trials) {
        condition.run_trial(trial, condition.free_number(trial),
                            plan.out.parent_path() / "trajectories" / trajectory_name(trial));
        if (condition.result().code != ExitCode::kOk) break;
    }
    return condition.close();
}

}  // namespace thimble
