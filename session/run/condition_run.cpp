#include "session/run/condition_run.hpp"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

#include "common/csv/csv_file.hpp"
#include "common/json_text.hpp"
#include "common/runtime/node_report.hpp"
#include "common/runtime/standard_streams.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/records/event_file.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {
namespace {

constexpr Duration kFlush = std::chrono::milliseconds{80};  // trajectory to the system
constexpr Duration kProgress = std::chrono::milliseconds{500};
constexpr Duration kClockNotes = std::chrono::seconds{1};  // offsets to the log, of each node

Sockets open_sockets(const ConditionPlan& plan, MessageLog* log) {
    Sockets sockets(plan.network);
    if (log != nullptr) sockets.record_to(*log, plan.log.messages == LoggedMessages::kAll);
    return sockets;
}

// Those that a condition of this process has carried out: one that comes between two conditions is the next one's.
std::atomic<unsigned> emergencies_taken{0};

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
            {"security", describe_security(sockets.security())}};
}

}  // namespace

template <class Write>
void ConditionRun::attempt(Write&& write) {
    try {
        write();
    } catch (const Error& error) {
        if (write_fault_.empty()) write_fault_ = error.what();
    }
}

ConditionRun::Company::Company(SessionProcess& session, std::unique_ptr<Process> observer, Security* security)
    : session_(&session), observer_(std::move(observer)), security_(security) {}

void ConditionRun::Company::tick(SessionTime now) {
    if (security_ != nullptr) security_->tick(now);
    session_->tick(now);
    if (observer_) observer_->tick(now);
    if (security_ != nullptr) security_->tick(now);
}

SessionTime ConditionRun::Company::next_wakeup() const {
    SessionTime next = session_->next_wakeup();
    if (security_ != nullptr) next = std::min(next, security_->next_wakeup());
    return observer_ ? std::min(next, observer_->next_wakeup()) : next;
}

ConditionRun::ConditionRun(const ConditionPlan& plan, const ConditionEvents& events)
    : plan_(plan),
      events_(events),
      realtime_(plan.runtime),
      log_(plan.log.messages == LoggedMessages::kNone ? nullptr : std::make_unique<MessageLog>()),
      sockets_(open_sockets(plan, log_.get())),
      session_(system_entropy(), plan.session, sockets_),
      company_(session_, plan.make_observer ? plan.make_observer(session_, sockets_, plan.name) : nullptr,
               sockets_.security()),
      loop_(sockets_.listeners()),
      stops_heard_(emergencies_taken),
      stop_file_(plan.network.base_port) {
    session_.set_sample_hook([this](const TrajectorySample& sample) {
        last_ = sample;
        if (writer_) attempt([&] { writer_->append(sample); });
    });
    session_.set_clock_hook([this](Role node, const ClockExchange& exchange) {
        if (clock_writer_) attempt([&] { clock_writer_->append(node, exchange); });
        note_clock(node, exchange);
    });
}

ConditionRun::~ConditionRun() {
    for (const auto& node : nodes_) node->stop();
}

void ConditionRun::open() {
    if (!plan_.holds_stop) stop_file_.require_released();
    make_folder(plan_.out);
    clock_writer_.emplace(clock_path());
    if (log_) open_log();
    if (plan_.starter) launch();
    wait_for_machines();
    wait_for_nodes();
}

// A node that was started anew does not write over what it had written.
std::string ConditionRun::again() const { return revivals_ == 0 ? "" : fmt::format("_again{}", revivals_); }

std::filesystem::path ConditionRun::report_path(std::size_t node) const {
    return plan_.out / fmt::format("{}_{:g}ms.json", kNodes[node].program, 1000 * plan_.delay_s);
}

std::filesystem::path ConditionRun::log_path(std::size_t node) const {
    return plan_.out / fmt::format("{}_{:g}ms{}.log", kNodes[node].program, 1000 * plan_.delay_s, again());
}

std::filesystem::path ConditionRun::clock_path() const {
    return plan_.out / fmt::format("clocks_{:g}ms.csv", 1000 * plan_.delay_s);
}

std::filesystem::path ConditionRun::messages_path(const std::string& program) const {
    return plan_.out / fmt::format("{}_{:g}ms{}.mcap", program, 1000 * plan_.delay_s, again());
}

void ConditionRun::open_log() {
    const auto path = messages_path("session");
    std::filesystem::remove(path);
    log_->start(path, {"session", plan_.session_file, {}}, plan_.log);
}

// As measured until now, once a second and node.
void ConditionRun::note_clock(Role node, const ClockExchange& exchange) {
    SessionTime& next = next_clock_note_.at(static_cast<std::size_t>(node));
    if (!log_ || exchange.answered < next) return;
    next = exchange.answered + kClockNotes;
    const auto offset = session_.clock_of(node).at(exchange.answered);
    if (!offset) return;
    log_->note("clock_offset", {{"node", to_string(node)},
                                {"offset_s", fmt::format("{:.9f}", offset->offset_s())},
                                {"bound_s", fmt::format("{:.9f}", offset->bound_s())},
                                {"at_ns", std::to_string(to_nanoseconds(exchange.answered))}});
}

void ConditionRun::note_trial(const TrialConditions& trial, std::uint32_t number) {
    if (!log_) return;
    log_->note("trial", {{"seed", std::to_string(trial.study_seed)},
                         {"experiment", std::to_string(trial.experiment)},
                         {"subject", std::to_string(trial.subject)},
                         {"trial", std::to_string(trial.trial)},
                         {"number_on_the_wire", std::to_string(number)},
                         {"modality", to_string(trial.modality)},
                         {"delay_s", fmt::format("{}", trial.delay_s)},
                         {"fixture_position_m", fmt::format("{}", trial.fixture_position_m)},
                         {"at_ns", std::to_string(to_nanoseconds(wall_now()))}});
}

// The file is the record; the summary is made from it.
void ConditionRun::close_clocks() {
    if (!clock_writer_) return;
    attempt([this] { clock_writer_->flush(); });
    clock_writer_.reset();
    if (!write_fault_.empty()) return;  // its last line may be half a one
    result_.clocks = clocks_of(plan_.delay_s, read_clock_file(clock_path()));
}

std::string ConditionRun::who_stopped() const {
    const StopBus& line = session_.stop_bus();
    return fmt::format("{} ({}): {}",
                       line.reason() == EndReason::kSafetyStop ? "safety stop" : "emergency stop",
                       to_string(line.raised_by()), line.words());
}

std::string ConditionRun::how_to_release() const {
    const int base = plan_.network.base_port;
    const auto& hosts = plan_.network.hosts;
    const bool by_file = plan_.network.security.mode != SecurityMode::kNone ||
                         std::any_of(hosts.begin(), hosts.end(), leaves_this_machine);
    std::string how(kHowToRelease);
    if (by_file && !plan_.session_file.empty()) how += " " + plan_.session_file.string();
    if (base != NetworkSettings::kDefaultBasePort) how += fmt::format(" --base-port {}", base);
    return how + stop_fault_;
}

std::string ConditionRun::stop_words() const {
    if (!session_.stop_bus().stopped()) return {};
    return fmt::format("{}; {}", who_stopped(), how_to_release());
}

void ConditionRun::keep_stop() {
    const bool held = session_.stop_bus().stopped();
    if (!held && !stop_kept_) return;
    stop_kept_ = held;
    try {
        if (held) {
            stop_file_.keep(who_stopped());
        } else {
            stop_file_.release(stop_file_.kept());
        }
        stop_fault_.clear();
    } catch (const Error& error) {
        if (stop_fault_.empty())
            say_words(fmt::format("a stop that is not kept ends with this program: {}\n", error.what()));
        stop_fault_ =
            fmt::format("; it ends with this program, since it could not be kept: {}", error.what());
    }
}

void ConditionRun::emergency_stop(std::string_view words) { session_.emergency_stop(wall_now(), words); }
void ConditionRun::release_stop() { session_.release_stop(wall_now()); }

void ConditionRun::hear_stop_key() {
    const unsigned asked = emergency_stops();
    if (asked == stops_heard_) return;
    stops_heard_ = emergencies_taken = asked;
    emergency_stop("Ctrl-\\ at thimble's terminal");
}

const TrialRecord& ConditionRun::run_trial(const TrialConditions& trial, std::uint32_t number,
                                           const std::filesystem::path& trajectory) {
    trajectory_ = trajectory;
    if (!trajectory.empty()) {
        make_folder(trajectory.parent_path());
        writer_.emplace(trajectory, plan_.if_exists);
    }
    note_trial(trial, number);
    if (halted_) result_ = {};
    halted_ = false;
    session_.start(trial, number);
    SessionTime next_poll{}, next_flush{}, next_progress{};
    while (!session_.finished()) {
        const SessionTime now = wall_now();
        loop_.step(company_, now + kPoll);
        if (now >= next_poll) look_around(now + kPoll, next_poll);
        if (now >= next_flush) {
            attempt([&] {
                if (writer_) writer_->flush();
                if (clock_writer_) clock_writer_->flush();
            });
            next_flush = now + kFlush;
        }
        if (now >= next_progress && events_.progress) {
            events_.progress(trial, last_);
            next_progress = now + kProgress;
        }
    }
    close_trial();
    return session_.record();
}

void ConditionRun::look_around(SessionTime next, SessionTime& next_poll) {
    next_poll = next;
    hear_stop_key();
    keep_stop();
    if (events_.stop && events_.stop()) return session_.abort(EndReason::kInterrupted);
    const bool cannot_write = !write_fault_.empty() || (log_ && !log_->fault().empty());
    if (cannot_write) return session_.abort(EndReason::kDeviceFault, Role::kSession);
    if (const auto dead = dead_node()) session_.abort(EndReason::kPeerLost, kNodes[*dead].role);
}

void ConditionRun::close_trial() {
    const TrialRecord& record = session_.record();
    if (writer_) {
        attempt([&] { writer_->end(record.reason, record.lost_peer); });
        writer_.reset();
        if (!record.network_events.empty())
            attempt([&] { write_events(event_path(trajectory_), record.network_events); });
    }
    // Not if whoever watches has ended the trial: then the condition goes on.
    if (record.reason == EndReason::kInterrupted && events_.stop && events_.stop()) {
        result_.code = ExitCode::kRunFailed;
        result_.problem = "interrupted; what was recorded is kept";
    } else if (is_stop(record.reason)) {
        halted_ = true;
        result_.code = ExitCode::kRunFailed;
        result_.problem = fmt::format("{}: {}", outcome_text(record.reason, record.lost_peer), record.fault);
        result_.problem += fmt::format("; {}", how_to_release());
    } else if (record.reason == EndReason::kDeviceFault) {
        result_.code = ExitCode::kRunFailed;
        result_.problem = words_of_fault(record);
    } else if (record.reason == EndReason::kPeerLost) {
        result_.code = ExitCode::kNetwork;
        const auto dead = dead_node();
        result_.problem = dead ? nodes_[*dead]->exit_message()
                               : fmt::format("lost contact with {}", to_string(record.lost_peer));
    }
    admit_write_fault(write_fault_);
    if (events_.trial_done) events_.trial_done(record);
}

// Also where a trial had ended well before: nothing is missing without a word.
void ConditionRun::admit_write_fault(std::string_view words) {
    if (words.empty() || result_.code != ExitCode::kOk) return;
    result_.code = ExitCode::kRunFailed;
    result_.problem = words;
}

// What cannot be written is told by whoever was to write it, as a device that fails is.
std::string ConditionRun::words_of_fault(const TrialRecord& record) const {
    if (record.lost_peer == Role::kSession && !write_fault_.empty()) return write_fault_;
    if (record.lost_peer == Role::kSession && log_) return std::string(log_->fault());
    if (record.fault.starts_with("the log "))
        return fmt::format("{}: {}", to_string(record.lost_peer), record.fault);
    return fmt::format("the device of {} failed: {}", to_string(record.lost_peer), record.fault);
}

void ConditionRun::idle(Duration limit) {
    const SessionTime end = wall_now() + limit;
    for (SessionTime now = wall_now(); now < end; now = wall_now()) {
        loop_.step(company_, std::min(end, now + kPoll));
        hear_stop_key();
        keep_stop();
        dead_node();
    }
}

// Whoever stops while nodes are being ended, or just before, has stopped the session and what comes after it.
void ConditionRun::take_last_stops() {
    company_.tick(wall_now());
    hear_stop_key();
    keep_stop();
    if (!session_.stop_bus().stopped() || result_.code != ExitCode::kOk) return;
    result_.code = ExitCode::kRunFailed;
    result_.problem = stop_words();
}

ConditionResult ConditionRun::close() {
    keep_stop();
    close_clocks();
    if (plan_.starter) end_nodes();
    take_last_stops();
    result_.reports.push_back(session_report(sockets_, realtime_.granted()));
    attempt([this] {
        CsvFile file(plan_.out / fmt::format("session_{:g}ms.json", 1000 * plan_.delay_s),
                     IfExists::kReplace);
        file.write(json_text(result_.reports.back(), 2) + "\n");
        file.flush();
    });
    admit_write_fault(write_fault_);
    if (log_) admit_write_fault(log_->close().fault);
    for (const auto& report : result_.reports) {
        if (report.contains("log")) admit_write_fault(report["log"].value("fault", ""));
    }
    return std::move(result_);
}

ConditionResult run_condition(const ConditionPlan& plan, const ConditionEvents& events) {
    ConditionRun condition(plan, events);
    condition.open();
    for (const TrialConditions& trial : plan.trials) {
        const auto name = fmt::format("trial{:02}_{}_{:g}ms.csv", trial.trial, to_string(trial.modality),
                                      1000 * trial.delay_s);
        condition.run_trial(trial, trial.trial, plan.out.parent_path() / "trajectories" / name);
        if (condition.result().code != ExitCode::kOk) break;
    }
    return condition.close();
}

}  // namespace thimble
