// The files of a condition's run, written as the data come: trajectories, exchanges of clocks, the session's log of
// messages. Also the paths of all its files. A failed write ends the trial. The data before it are kept. While a trial runs, a thread
// of its own waits for the disk, because nodes that miss the session for kPeerTimeout give the trial up.
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <boost/core/noncopyable.hpp>
#include <nlohmann/json.hpp>

#include "common/runtime/log/message_log.hpp"
#include "session/clocks/clock_prober.hpp"
#include "session/clocks/clock_summary.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/run/condition_plan.hpp"

namespace thimble {

// The session's log says this of each trial. `number`: the trial's on the wire.
McapMap trial_note(const TrialConditions& trial, std::uint32_t number, SessionTime at);

class ConditionFiles : boost::noncopyable {
  public:
    // `plan` outlives the files. `log`: whether the log that the plan names is one of them.
    explicit ConditionFiles(const ConditionPlan& plan, bool log = true);
    ~ConditionFiles();

    // Throws Error (usage) if the folder or a file cannot be made.
    void open();
    MessageLog* log() const { return log_.get(); }  // null: no message is to be written

    std::filesystem::path report_path(std::size_t node) const;
    std::filesystem::path log_path(std::size_t node) const;  // what its program says
    std::filesystem::path messages_path(const std::string& program) const;
    // From now on the nodes' files have other names, so a new node overwrites no file.
    void nodes_start_anew() { ++restarts_; }

    // Waits for the disk, as end_trial() and close_clocks() do. `trajectory`: empty, if none is to be written.
    void begin_trial(const TrialConditions& trial, std::uint32_t number,
                     const std::filesystem::path& trajectory);
    void add(const TrajectorySample& sample);
    void add(Role node, const ClockExchange& exchange, const ClockFilter& clock);
    // Hands all that was added to the thread. While the thread waits for the disk, the lines stay here for a later call.
    void flush();
    void end_trial(const TrialRecord& record);

    // The clocks, computed from the exchanges in their file. None after a fault.
    std::vector<NodeClock> close_clocks();
    void write_session_report(const nlohmann::ordered_json& report);

    // Why a file could not be written; empty: all could, as far as the thread had come at the last flush().
    const std::string& fault() const { return fault_; }
    // The same of the log of messages.
    std::string log_fault() const { return log_ ? std::string(log_->fault()) : std::string(); }

  private:
    enum class Writing { kNothing, kHandedOver, kEnds };  // nothing: the thread waits
    struct Lines {
        std::vector<TrajectorySample> samples;
        std::vector<ClockRecord> clocks;
    };

    template <class Write>
    void attempt(Write&& write);
    void start();
    void write(Lines& lines);
    void write_until_ended();
    void settle();
    std::filesystem::path clock_path() const;
    std::string again() const;
    void note(Role node, const ClockExchange& exchange, const ClockFilter& clock);

    const ConditionPlan& plan_;
    std::unique_ptr<MessageLog> log_;
    std::array<SessionTime, kRoleCount> next_clock_note_{};
    std::optional<TrajectoryWriter> writer_;
    std::filesystem::path trajectory_;
    std::optional<ClockWriter> clock_writer_;
    std::string fault_;
    unsigned restarts_ = 0;
    Lines fresh_;
    // The thread's while it writes, as the writers are.
    Lines handed_over_;
    std::string attempt_;  // why one failed
    std::atomic<Writing> writing_{Writing::kNothing};
    std::thread thread_;
};

}  // namespace thimble
