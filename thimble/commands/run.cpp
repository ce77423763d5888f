#include "thimble/commands/run.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "analysis/report/report.hpp"
#include "analysis/report/run_tables.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "session/clocks/chrony.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/run/condition_run.hpp"
#include "session/settings/protocol.hpp"
#include "session/virtual/lock_step_session.hpp"
#include "session/virtual/ping_pong.hpp"
#include "session/virtual/virtual_condition.hpp"
#include "study/study_folder.hpp"

namespace thimble {
namespace {

// Nodes that run already have the delay that their own file gives them, which is to be this one.
std::vector<Duration> delay_of_running_nodes(const SystemSettings& settings) {
    const Duration theirs = settings.netem.force.delay;
    if (!settings.plan.names_delays || settings.plan.delays == std::vector{theirs}) return {theirs};
    throw Error(ExitCode::kUsage,
                fmt::format("the running programs have one delay, {} s by this file, but [session] delays_s "
                            "names others: name one delay, and no profile in [netem.force], in this file and "
                            "in the file of the running thimble-netem",
                            to_seconds(theirs)));
}

class Run {
  public:
    Run(const SystemSettings& settings, const RunOptions& options)
        : settings_(settings),
          options_(options),
          if_exists_(options.overwrite ? IfExists::kReplace : IfExists::kRefuse),
          delays_(options.starter ? settings.plan.delays : delay_of_running_nodes(settings)) {
        const std::size_t ports = condition_count() * static_cast<std::size_t>(Port::kCount);
        if (options.network.base_port + ports <= 65536) return;
        throw Error(ExitCode::kUsage, fmt::format("{} conditions need {} ports from {} on, but the last port "
                                                  "is 65535: choose a smaller base_port in [network]",
                                                  condition_count(), ports, options.network.base_port));
    }

    RunResult run() {
        make_folder(options_.out);
        TrialTable table(options_.out / "trials.csv", if_exists_);
        table_ = &table;
        if (options_.overwrite) {
            remove_earlier_logs();
            remove_earlier_results(options_.out);
        }
        if (by(RunClock::kWall)) {
            progress_.say("measuring the round trip between two processes, without a session");
            bare_ = measure_ping_pong(options_.runtime);
        }
        const SessionTime begin = wall_now();
        run_conditions();
        time_.wall_s = to_seconds(wall_now() - begin);
        if (failure_ && result_.rows.empty()) std::rethrow_exception(failure_);
        conclude();
        if (failure_) std::rethrow_exception(failure_);
        return std::move(result_);
    }

  private:
    // Their names, as "thimble-netem_50ms_trial02.mcap", have delays and trials that this run need not have.
    void remove_earlier_logs() const {
        std::error_code absent;
        std::vector<std::filesystem::path> logs;
        for (const auto& file : std::filesystem::directory_iterator(options_.out / "nodes", absent)) {
            const std::string name = file.path().filename().string();
            const std::size_t delay = name.find('_') + 1;
            const bool ours = name.starts_with("session_") || name.starts_with("thimble-");
            if (ours && name.ends_with(".mcap") && std::isdigit(static_cast<unsigned char>(name[delay])) != 0)
                logs.push_back(file.path());
        }
        for (const auto& log : logs) remove_file(log);
    }

    bool by(RunClock clock) const { return options_.clock == clock; }
    // Virtual time has Thimble's programs alone.
    // A plug-in that crashed or hung would do so again, for as long as the limit of run_isolated().
    bool compares() const {
        const bool plugin_failed =
            result_.code != ExitCode::kOk && settings_.master.control.compensator == Compensator::kPlugin;
        return !by(RunClock::kVirtual) && settings_.launch.own_program_key().empty() && !plugin_failed;
    }
    bool elsewhere() const { return options_.starter && runs_elsewhere(*options_.starter); }

    unsigned condition_count() const {
        if (by(RunClock::kVirtual) || options_.step) return 1;
        return conditions_at_once(settings_, delays_.size(), elsewhere(), options_.clock);
    }

    // Conditions take the next delay until none is left or something went wrong.
    void run_conditions() {
        std::vector<std::thread> threads;
        for (unsigned place = 0; place < condition_count(); ++place) {
            try {
                threads.emplace_back([this, place] { work(place); });
            } catch (const std::system_error&) {  // no thread is free: fewer conditions at once
                if (threads.empty()) throw;
                break;
            }
        }
        for (std::thread& thread : threads) thread.join();
        try {
            while (turn_ < delays_.size()) pass_turn();
        } catch (...) {
            if (!failure_) failure_ = std::current_exception();
        }
    }

    void work(unsigned place) {
        for (;;) {
            std::unique_lock lock(mutex_);
            const bool given_up = result_.code != ExitCode::kOk && interrupted();
            if (failed_ || stopped_ || given_up || next_delay_ >= delays_.size()) return;
            const std::size_t delay = next_delay_++;
            lock.unlock();
            try {
                run_delay(place, delay);
            } catch (...) {
                const std::lock_guard guard(mutex_);
                if (!failure_) failure_ = std::current_exception();
                failed_ = failed_ || by(RunClock::kWall);
            }
        }
    }

    void pass_turn() {
        if (++turn_ == delays_.size()) return;
        for (const TrialRecord& record : waiting_[turn_]) write(record);
        waiting_[turn_].clear();
    }

    ConditionPlan plan(unsigned place, double delay_s) const {
        ConditionPlan plan;
        plan.starter = options_.starter;
        plan.out = options_.out / "nodes";
        plan.network = options_.network;
        plan.network.base_port =
            static_cast<std::uint16_t>(plan.network.base_port + place * static_cast<unsigned>(Port::kCount));
        plan.session = session_settings(with_force_delay(settings_, from_seconds(delay_s)));
        plan.session.ends_by_withdrawal = held_by_person(settings_.handle.kind);
        plan.delay_s = delay_s;
        plan.place = place;
        if (condition_count() > 1) plan.name = delay_in_names(delay_s);
        plan.trials = run_trials_of(settings_, delay_s);
        plan.make_observer = options_.make_observer;
        plan.runtime = settings_.runtime;
        plan.strict_rt = options_.strict_rt;
        plan.answer_limit = options_.answer_limit;
        plan.if_exists = if_exists_;
        if (!by(RunClock::kVirtual)) plan.log = settings_.log;
        plan.session_file = settings_.file;
        return plan;
    }

    void run_delay(unsigned place, std::size_t delay) {
        const double delay_s = to_seconds(delays_[delay]);
        const ConditionPlan planned = plan(place, delay_s);
        ConditionEvents events;
        events.stop = [this] { return failed_ || stopped_ || interrupted(); };
        if (!options_.step)
            events.progress = [this](const TrialConditions& c, const TrajectorySample& s) { show(c, s); };
        events.trial_done = [this, delay](const TrialRecord& record) { keep(delay, record); };
        ConditionResult result = run_by_clock(planned, events);
        const std::lock_guard guard(mutex_);
        for (auto& node : result.reports) nodes_.push_back({delay_s, std::move(node)});
        clocks_.insert(clocks_.end(), result.clocks.begin(), result.clocks.end());
        time_.simulated_s += result.simulated_s;
        done_[delay] = true;
        while (turn_ < delays_.size() && done_[turn_]) pass_turn();
        if (result.code != ExitCode::kOk) fail(delay, result);
    }

    // In real time the first problem ends all conditions. Where bytes are repeatable the others go on, and the problem of the first
    // delay counts: else what is recorded depended on which condition was quicker.
    void fail(std::size_t delay, const ConditionResult& result) {
        failed_ = failed_ || by(RunClock::kWall);
        if (result_.code != ExitCode::kOk && (by(RunClock::kWall) || failed_delay_ < delay)) return;
        failed_delay_ = delay;
        result_.code = result.code;
        result_.problem = result.problem;
    }

    bool interrupted() const {
        return (options_.stop != nullptr && *options_.stop) || (options_.quit && options_.quit());
    }

    ConditionResult run_by_clock(const ConditionPlan& planned, const ConditionEvents& events) const {
        if (by(RunClock::kWall)) return run_condition(planned, events);
        if (by(RunClock::kLockStep)) return by_lock_step(planned, events);
        return run_virtual_condition(planned, events,
                                     with_force_delay(settings_, from_seconds(planned.delay_s)));
    }

    ConditionResult by_lock_step(const ConditionPlan& planned, const ConditionEvents& events) const {
        LockStepNodes nodes(planned);
        const MakeSteppedSession make = [this, &nodes]() -> std::unique_ptr<SteppedSession> {
            if (!options_.step) return nodes.make_session();
            return std::make_unique<PausedSession>(nodes.make_session(), *options_.step);
        };
        ConditionResult result = run_stepped_condition(planned, events, make);
        nodes.end(result);
        return result;
    }

    // A trial does not wait: another condition may hold the lock until the disk has its row.
    void show(const TrialConditions& c, const TrajectorySample& s) {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock) return;
        progress_.show(fmt::format("{} {}: {:.1f} s, needle {:.1f} mm, force {:.2f} N, contact {:.1f} s",
                                   delay_text(c.delay_s), to_string(c.modality), s.time_s,
                                   1000 * s.position_needle_m, s.force_total_N, s.contact_time_s),
                       false);
    }

    // In real time as trials end. Where bytes are repeatable, the table has the order of the delays, whichever was first.
    void keep(std::size_t delay, const TrialRecord& record) {
        const std::lock_guard guard(mutex_);
        stopped_ = stopped_ || record.reason == EndReason::kEmergencyStop;
        if (by(RunClock::kWall) || delay == turn_) return write(record);
        waiting_[delay].push_back(record);
    }

    void write(const TrialRecord& record) {
        const TrialRow row = make_row(record);
        table_->append(row);
        panels_.add(record);
        result_.rows.push_back(row);
        const bool touched = !std::isnan(row.metrics.first_contact_time_s);
        progress_.say(fmt::format("{} {}: {}{}", delay_text(row.conditions.delay_s),
                                  to_string(row.conditions.modality), course_text(row),
                                  touched ? contact_text(row.metrics) : ""));
    }

    static std::string contact_text(const TrialMetrics& metrics) {
        return fmt::format(", contacts lost {}, {}", metrics.contacts_lost,
                           metrics.oscillates ? "oscillates" : "settles");
    }

    // Keeps an earlier problem, such as a full disk.
    void conclude() {
        try {
            repeat_virtually();
            report();
        } catch (...) {
            if (!failure_ && result_.code == ExitCode::kOk) throw;
        }
    }

    void repeat_virtually() {
        if (!compares()) return;
        TrialTable table(options_.out / "virtual.csv", if_exists_);
        for (const TrialRow& row : result_.rows) {
            result_.virtual_rows.push_back(make_row(run_virtual_trial(settings_, row.conditions)));
            table.append(result_.virtual_rows.back());
        }
    }

    std::string trials_title() const {
        if (by(RunClock::kVirtual)) return "Virtual time";
        return by(RunClock::kWall) ? "Real processes, real time" : "Real processes in lock-step";
    }

    ReportSection timing_section() const {
        ReportSection timing;
        timing.title = "Accuracy of the timing";
        timing.tables = {round_trip_table(result_.rows, bare_), clock_table(clocks_), deadline_table(nodes_),
                         refusal_table(nodes_)};
        std::array extra{security_table(nodes_), stale_table(nodes_)};
        for (ReportTable& table : extra) {
            if (!table.rows.empty()) timing.tables.push_back(std::move(table));
        }
        if (elsewhere()) timing.tables.push_back(machine_table(*options_.starter, options_.network));
        return timing;
    }

    ReportSection clock_section() const {
        ReportSection section;
        section.title = "The clock";
        const bool one_program = by(RunClock::kVirtual);
        section.text = fmt::format(
            "{}, whose clock jumps from event to event: {:.1f} s of it took {:.1f} s. Therefore this run has "
            "no {}round trip by the wall clock and no lateness.",
            one_program ? "All processes of the session were in one program"
                        : "The programs of the session took their time from thimble run",
            time_.simulated_s, time_.wall_s, one_program ? "reports and logs of nodes, no " : "");
        section.tables = {refusal_table(nodes_), security_table(nodes_), stale_table(nodes_)};
        if (by(RunClock::kLockStep) && elsewhere())
            section.tables.push_back(machine_table(*options_.starter, options_.network));
        return section;
    }

    void report() const {
        const std::vector<GroupFindings> findings = findings_of(result_.rows);
        write_findings(findings, options_.out / "findings.json");
        ReportInput report;
        report.title =
            by(RunClock::kVirtual) ? "Thimble: a run in virtual time" : "Thimble: real processes over UDP";
        report.time = time_;
        report.answers = {{"", answer(findings)}};
        report.sections.push_back(
            trials_section(trials_title(), result_.rows, findings,
                           draw_figures(panels_.panels(), summarize(result_.rows), options_.out,
                                        by(RunClock::kVirtual) ? "_virtual" : "_real")));
        if (compares()) report.sections.push_back(agreement_section(result_.rows, result_.virtual_rows));
        report.sections.push_back(by(RunClock::kWall) ? timing_section() : clock_section());
        report.provenance = {{"command", options_.command},
                             {kDesign, kUsersDesign},
                             {"seed", std::to_string(settings_.plan.seed)},
                             {"subject", std::to_string(settings_.plan.subject)},
                             {"version", kVersion},
                             {"clock", to_string(options_.clock)},
                             {"clock daemon", describe_chrony()},
                             {"outcome", result_.code == ExitCode::kOk ? "complete" : result_.problem}};
        for (const NodeKind& node : kNodes) {
            if (const auto& own = settings_.launch.own_program(node.role); options_.starter && !own.empty())
                report.provenance.emplace_back(node.program, own.string());
        }
        report.provenance.insert(report.provenance.end(), options_.made_with.begin(),
                                 options_.made_with.end());
        if (!held_by_person(settings_.handle.kind)) say_virtual_subjects(report);
        write_report(report, options_.out / "report.html");
        write_summary(report, options_.out / "summary.json");
    }

    const SystemSettings& settings_;
    const RunOptions& options_;
    IfExists if_exists_;
    std::vector<Duration> delays_;
    std::mutex mutex_;
    Progress progress_;
    TrialTable* table_ = nullptr;
    TrajectoryPanels panels_;
    Histogram bare_;
    RunTime time_{to_string(options_.clock)};
    std::vector<NodeReport> nodes_;
    std::vector<NodeClock> clocks_;
    std::size_t next_delay_ = 0;
    std::size_t turn_ = 0;  // the delay whose trials are written as they end
    std::vector<std::vector<TrialRecord>> waiting_ = std::vector<std::vector<TrialRecord>>(delays_.size());
    std::vector<bool> done_ = std::vector<bool>(delays_.size());
    std::atomic<bool> failed_ = false;   // all conditions are to end
    std::atomic<bool> stopped_ = false;  // likewise: a person stopped everything
    std::size_t failed_delay_ = 0;       // whose problem is the run's
    std::exception_ptr failure_;
    RunResult result_;
};

}  // namespace

std::vector<TrialConditions> run_trials_of(const SystemSettings& settings, double delay_s) {
    Protocol protocol = experiment_3(settings, settings.plan.subject, settings.plan.seed);
    std::vector<TrialConditions> trials;
    for (const Modality modality : settings.plan.modalities) {
        const auto number = static_cast<std::uint32_t>(trials.size() + 1);
        trials.push_back({protocol.seed, protocol.experiment, settings.plan.subject, number, modality,
                          delay_s, draw_fixture_position_m(protocol, settings.plan.subject, number)});
    }
    return trials;
}

unsigned conditions_at_once(const SystemSettings& settings, std::size_t delays, bool elsewhere,
                            RunClock clock) {
    // A person has one hand, and one device that can be opened once; a participant's session has one delay.
    if (held_by_person(settings.handle.kind) || settings.protocol) return 1;
    // One condition at a time if other machines take part: their number of cores is unknown here.
    const unsigned cores = elsewhere ? 1 : std::thread::hardware_concurrency();
    const unsigned by_itself = clock == RunClock::kLockStep ? cores : cores / 2;
    const unsigned wanted = settings.plan.parallel_conditions > 0
                                ? static_cast<unsigned>(settings.plan.parallel_conditions)
                                : std::max(1U, by_itself);
    return std::min(wanted, static_cast<unsigned>(delays));
}

RunResult run_session(const SystemSettings& settings, const RunOptions& options) {
    return Run(settings, options).run();
}

}  // namespace thimble
