// The conductor of lock-step: the five node programs of a condition, over UDP, by the order and the clock of virtual time.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <sched.h>
#include <string>
#include <thread>
#include <vector>

#include "common/runtime/grant_stream.hpp"
#include "common/runtime/lock_step.hpp"
#include "session/run/condition_nodes.hpp"
#include "session/virtual/stepped_condition.hpp"
#include "session/virtual/virtual_loop.hpp"

namespace thimble {

// Datagrams that were sent and are not announced yet, by port. The owner of the port is woken.
class AnnouncedMail {
  public:
    explicit AnnouncedMail(std::uint32_t* woken) : woken_(woken) {}
    void wake(Role role, std::uint32_t bit) { bits_.at(static_cast<std::size_t>(role)) = bit; }
    void post(std::span<const std::uint16_t> sent);
    // For the ports of one program; the others are zero.
    void take(Role role, std::span<std::uint16_t> datagrams);
    // Whether a node has nothing to answer before it is due: forces, percepts and pictures alone wait for it, and no beep.
    bool only_data(Role role) const;

  private:
    std::uint32_t* woken_;
    std::array<std::uint32_t, kRoleCount> bits_{};
    DatagramCounts waiting_{};
    bool beep_ = false;  // waits for visual
};

// A node's program as a process of the loop: a tick is a grant and its answer. One that is lost is never due again.
class GrantedProcess final : public Process {
  public:
    GrantedProcess(Role role, LockStepEnd& end, AnnouncedMail& mail) : role_(role), end_(end), mail_(mail) {}

    void begin(Duration limit);
    void await_ready() { take(LockStepKind::kReady); }
    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override { return next_; }
    bool stopped() const override { return false; }

    Role role() const { return role_; }
    // Why the node takes no part any more; none if it does.
    std::optional<LockStepEnd::Silence> silence() const { return silence_; }

  private:
    bool may_be_quiet(SessionTime now) const;
    std::optional<LockStepMessage> receive();
    void take(LockStepKind expected);
    void lose(LockStepEnd::Silence silence);

    Role role_;
    LockStepEnd& end_;
    AnnouncedMail& mail_;
    static constexpr int kMostDueAtOnce = 1000;
    static constexpr unsigned kMostQuiet = LockStepPage::kRoom - 2;

    SessionTime next_ = kNever;
    int due_at_once_ = 0;  // answers in a row
    unsigned quiet_ = 0;   // grants since the last answer
    SessionTime quiet_until_{};
    std::optional<LockStepEnd::Silence> silence_;
};

// The thread that makes it, and the programs that it starts, run on one core, another one at each place: a wake-up
// across cores takes ten times one on the same.
class CoreLease : boost::noncopyable {
  public:
    explicit CoreLease(unsigned place);
    ~CoreLease() { sched_setaffinity(0, sizeof before_, &before_); }

  private:
    cpu_set_t before_{};
};

class LockStepNodes : boost::noncopyable {
  public:
    // Starts the programs. `plan` outlives this. Throws Error: run failed, if there is no such program; network, if a machine does not
    // answer, or its node does not find the way back.
    explicit LockStepNodes(const ConditionPlan& plan);
    ~LockStepNodes() { stop_keeping(); }

    // A fresh session and nodes as good as fresh; one at a time. Throws Error (network), with its words, if a node does not begin.
    std::unique_ptr<SteppedSession> make_session();
    // Ends the programs and collects their reports.
    void end(ConditionResult& result);

    const ConditionPlan& plan() const { return plan_; }
    LockStepEnd& of(std::size_t node) { return *ends_.at(node); }
    pid_t pid(std::size_t node) const { return nodes_.at(node).pid(); }
    // Of the session's own log; the trial's number goes behind it.
    std::filesystem::path session_log() const { return files_.messages_path("session"); }
    // How a node was lost.
    LostNode lost(Role role, LockStepEnd::Silence silence, SessionTime now);

  private:
    void let_in(GrantDoor& door);
    bool all_in() const;
    void keep_machines();
    void stop_keeping();

    const ConditionPlan& plan_;
    CoreLease core_;
    ConditionFiles files_;  // for their paths
    ConditionNodes nodes_;
    std::array<std::unique_ptr<LockStepEnd>, kNodes.size()> ends_;
    // While the conductor waits for an answer, nodes on other machines need a sign of life.
    std::mutex mutex_;  // of nodes_
    std::atomic<bool> kept_ = false;
    std::thread keeper_;
};

}  // namespace thimble
