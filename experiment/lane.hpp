// One condition of a real-time run: five node processes, here or on other machines, a session that steers them through
// its trials, everything recorded as it comes.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/sockets.hpp"
#include "experiment/clocks/clock_table.hpp"
#include "experiment/launch/node_starter.hpp"
#include "experiment/session_process.hpp"
#include "experiment/trajectory_file.hpp"

namespace thimble {

// Somebody to sit beside a session.
using MakeAttendant = std::function<std::unique_ptr<Process>(SessionProcess&, Sockets&)>;

struct LanePlan {
    std::shared_ptr<NodeStarter>
        starter;  // none: the nodes run already, started by somebody else, and go on running
    std::filesystem::path out;
    NetworkSettings network;
    SessionSettings session;
    double delay_s = 0;  // of the force path
    std::vector<TrialConditions> trials;
    // Sits beside the session and is called right after it, with the session's clock; none: nobody watches. What it
    // opens among the sockets wakes the lane.
    MakeAttendant attend{};
    bool strict_rt = false;
    IfExists if_exists = IfExists::kRefuse;
};

struct LaneEvents {
    std::function<void(const TrialRecord&)> trial_done;  // may be empty, as the next two
    std::function<void(const TrialConditions&, const TrajectorySample&)> progress;  // twice a second
    std::function<bool()> stop;
};

struct LaneResult {
    ExitCode code = ExitCode::kOk;
    std::string problem;                          // why it ended early; empty if it did not
    std::vector<nlohmann::ordered_json> reports;  // one per node that could still write it
    std::vector<NodeClock> clocks;
};

class Lane {
  public:
    // `plan` and `events` outlive the lane. Throws Error: network, if a port is taken.
    Lane(const LanePlan& plan, const LaneEvents& events);
    ~Lane();  // ends the nodes, all at once
    Lane(const Lane&) = delete;
    Lane& operator=(const Lane&) = delete;

    // Starts the nodes, unless they run already, and waits for them. Throws Error: network, with the words of
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
    // A node has ended, or was lost: this lane runs no further trial.
    bool broken() { return result_.code != ExitCode::kOk || dead_node(); }
    // What happened so far: not ok once a peer was lost, or a stop was asked for.
    const LaneResult& result() const { return result_; }
    // Ends the nodes that open() started and collects their reports.
    LaneResult close();

  private:
    // The session and whoever sits beside it, as one, behind what protects the sockets.
    class Company final : public Process {
      public:
        Company(SessionProcess& session, std::unique_ptr<Process> attendant, Security* security);
        void tick(SessionTime now) override;
        SessionTime next_wakeup() const override;
        bool stopped() const override { return false; }

      private:
        SessionProcess* session_;
        std::unique_ptr<Process> attendant_;
        Security* security_;
    };

    std::string why_silent() const;

    SessionProcess::Channels open_channels();
    std::filesystem::path report_path(std::size_t node) const;
    std::filesystem::path clock_path() const;
    void close_clocks();
    void launch();
    std::optional<std::size_t> dead_node();
    void throw_if_dead();
    void wait_for_machines();
    void wait_for_nodes();
    void look_around(SessionTime next, SessionTime& next_poll);
    void close_trial();

    const LanePlan& plan_;
    const LaneEvents& events_;
    Sockets sockets_;
    SessionProcess session_;
    Company company_;
    RealtimeLoop loop_;
    std::vector<std::unique_ptr<RunningNode>> nodes_;
    std::optional<TrajectoryWriter> writer_;
    std::filesystem::path trajectory_;
    std::optional<ClockWriter> clock_writer_;
    TrajectorySample last_;
    LaneResult result_;
};

// Runs the trials of the plan. Throws Error as Lane does.
LaneResult run_lane(const LanePlan& plan, const LaneEvents& events);

}  // namespace thimble
