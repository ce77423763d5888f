// One condition of a real-time run: five node processes, here or on other machines, a session that steers them through
// its trials, everything recorded as it comes.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/log/log_settings.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/log/message_log.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/sockets.hpp"
#include "session/clocks/clock_summary.hpp"
#include "session/launch/node_starter.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/run/session_process.hpp"
#include "session/run/stop_file.hpp"

namespace thimble {

// Somebody to sit beside a session; `condition` is ConditionPlan::name.
using MakeObserver =
    std::function<std::unique_ptr<Process>(SessionProcess&, Sockets&, const std::string& condition)>;

struct ConditionPlan {
    std::shared_ptr<NodeStarter>
        starter;  // none: the nodes run already, started by somebody else, and go on running
    std::filesystem::path out;
    NetworkSettings network;
    SessionSettings session;
    double delay_s = 0;  // of the force path
    std::string name{};  // among conditions that run at the same time, "50ms"; empty: there is no other
    std::vector<TrialConditions> trials;
    // Sits beside the session and is called right after it, with the session's clock; none: nobody watches. What it
    // opens among the sockets wakes the condition.
    MakeObserver make_observer{};
    RuntimeSettings runtime{};
    bool strict_rt = false;
    // What session and nodes write down of their messages, in NAME_<delay>ms.mcap in `out`.
    LogSettings log{LoggedMessages::kNone, {}, {}};
    std::filesystem::path session_file{};  // kept with it
    IfExists if_exists = IfExists::kRefuse;
    bool holds_stop = false;  // the one that is kept is its own: whoever plans this raises it again
};

struct ConditionEvents {
    std::function<void(const TrialRecord&)> trial_done;  // may be empty, as the next two
    std::function<void(const TrialConditions&, const TrajectorySample&)> progress;  // twice a second
    std::function<bool()> stop;
};

struct ConditionResult {
    ExitCode code = ExitCode::kOk;
    std::string problem;                          // why it ended early; empty if it did not
    std::vector<nlohmann::ordered_json> reports;  // one per node that could still write it
    std::vector<NodeClock> clocks;
};

class ConditionRun {
  public:
    // `plan` and `events` outlive the condition. Throws Error: network, if a port is taken.
    ConditionRun(const ConditionPlan& plan, const ConditionEvents& events);
    ~ConditionRun();  // ends the nodes, all at once
    ConditionRun(const ConditionRun&) = delete;
    ConditionRun& operator=(const ConditionRun&) = delete;

    // Starts the nodes, unless they run already, and waits for them. Throws Error: run failed, if a stop of an earlier session
    // holds (stop_file.hpp); network, with the words of
    // the node that failed; run failed, if a machine has no such program, or another version of it.
    void open();
    // Throws Error (network), with its words, if a node has ended by itself.
    void check() { throw_if_dead(); }
    // Runs one trial to its end, which may be that a peer was lost or a stop was asked for. `number` tells it
    // apart from the last one on the wire (session_process.hpp).
    const TrialRecord& run_trial(const TrialConditions& trial, std::uint32_t number,
                                 const std::filesystem::path& trajectory);  // empty: none is written
    std::uint32_t last_number() const { return session_.last_number(); }
    // What the subject's screen says until the next trial.
    void show(const Page& page) { session_.show(page); }
    // Whether the subject has asked to go on from it since the last call.
    bool take_go_on() { return session_.take_go_on(); }
    // Keeps in touch with the nodes between trials, for at most `limit`.
    void idle(Duration limit);
    // A node has ended, or was lost: this condition runs no further trial. After a stop it does, once that was released.
    bool broken() { return (result_.code != ExitCode::kOk && !halted_) || dead_node(); }
    // Who stopped everything, why and how to release it; empty: nothing is stopped.
    std::string stop_words() const;
    void emergency_stop(std::string_view words);
    void release_stop();
    // Starts the nodes anew that have ended, those alone, and waits for them; they know nothing of the trials before and take
    // part from the next one on. False if there was nothing to start. Throws Error as open() does.
    bool revive();
    // What happened so far: not ok once a peer was lost, or a stop was asked for.
    const ConditionResult& result() const { return result_; }
    // Ends the nodes that open() started and collects their reports.
    ConditionResult close();

  private:
    // The session and whoever sits beside it, as one, behind what protects the sockets.
    class Company final : public Process {
      public:
        Company(SessionProcess& session, std::unique_ptr<Process> observer, Security* security);
        void tick(SessionTime now) override;
        SessionTime next_wakeup() const override;
        bool stopped() const override { return false; }

      private:
        SessionProcess* session_;
        std::unique_ptr<Process> observer_;
        Security* security_;
    };

    static constexpr Duration kPoll = std::chrono::milliseconds{20};  // look after children, stop requests

    std::string why_silent() const;

    std::string again() const;
    std::filesystem::path report_path(std::size_t node) const;
    std::filesystem::path log_path(std::size_t node) const;
    std::filesystem::path clock_path() const;
    std::filesystem::path messages_path(const std::string& program) const;
    void open_log();
    void note_clock(Role node, const ClockExchange& exchange);
    void note_trial(const TrialConditions& trial, std::uint32_t number);
    // What cannot be written ends the trial, with what was written.
    template <class Write>
    void attempt(Write&& write);
    void admit_write_fault(std::string_view words);
    std::string words_of_fault(const TrialRecord& record) const;
    void close_clocks();
    void launch();
    void end_nodes();
    std::unique_ptr<RunningNode> start_node(std::size_t node);
    void hear_stop_key();
    std::string who_stopped() const;
    std::string how_to_release() const;
    // The stop file says what the stop bus holds.
    void keep_stop();
    void take_last_stops();
    std::optional<std::size_t> dead_node();
    void throw_if_dead();
    void wait_for_machines();
    void wait_for_nodes();
    void pass_on_words(std::size_t& passed) const;
    void look_around(SessionTime next, SessionTime& next_poll);
    void close_trial();

    const ConditionPlan& plan_;
    const ConditionEvents& events_;
    RealtimeLease realtime_;  // nodes hold where the session is silent: other work must not silence it
    std::unique_ptr<MessageLog> log_;  // none: nothing is to be written; it outlives whoever speaks
    std::array<SessionTime, kRoleCount> next_clock_note_{};
    Sockets sockets_;
    SessionProcess session_;
    Company company_;
    RealtimeLoop loop_;
    std::vector<std::unique_ptr<RunningNode>> nodes_;
    std::optional<TrajectoryWriter> writer_;
    std::filesystem::path trajectory_;
    std::optional<ClockWriter> clock_writer_;
    std::string write_fault_;  // empty: all could be written
    TrajectorySample last_;
    ConditionResult result_;
    bool halted_ = false;       // by a stop: the result says so until the next trial
    unsigned stops_heard_ = 0;  // of emergency_stops()
    StopFile stop_file_;
    bool stop_kept_ = false;
    std::string stop_fault_;  // why a stop could not be kept; empty: it could
    unsigned revivals_ = 0;
};

// Runs the trials of the plan. Throws Error as ConditionRun does.
ConditionResult run_condition(const ConditionPlan& plan, const ConditionEvents& events);

}  // namespace thimble
