// One condition of a run whose time is granted, not measured: each trial has a fresh session, which goes from instant to instant.
// Its files are written by the code that writes them in real time (condition_files.hpp).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/random.hpp"
#include "session/run/condition_plan.hpp"

namespace thimble {

// A node that takes no part any more, and why.
struct LostNode {
    Role role{};
    std::string words;
    ExitCode code = ExitCode::kNetwork;
};

struct DueProgram {
    Role role{};
    pid_t pid = -1;
    SessionTime next = kNever;  // or with the next datagram, if that comes before
};

// The number of each program in the headers of its messages, the same in every session.
inline std::uint64_t granted_instance(Role role) {
    RandomStream stream({0, 0, 0, static_cast<std::uint32_t>(role), Purpose::kInstance});
    return stream();
}

// The order of nodes that are due at the same time. The session runs before them. slave_sim runs last: without delay, visual then hears
// its picture and its force in one tick.
inline constexpr std::array kTickOrder{Role::kMaster, Role::kNetem, Role::kCutaneous, Role::kVisual,
                                       Role::kSlaveSim};

// Handshakes without delay need fewer.
inline constexpr int kMostInstantsForKeys = 100;

class SteppedSession : boost::noncopyable {
  public:
    virtual ~SteppedSession() = default;

    virtual SessionProcess& session() = 0;
    virtual void start(const TrialConditions& conditions) = 0;
    virtual bool step() = 0;  // one instant; false once the trial has ended
    virtual SessionTime now() const = 0;
    virtual const std::optional<LostNode>& lost() const = 0;
    // When each program is due; none if the session has no programs.
    virtual std::vector<DueProgram> due() const { return {}; }
    // Why something could not be written; empty: nothing is wrong.
    virtual std::string fault() const { return {}; }
    // Hears programs outside the session, which may stop it.
    virtual void look_outside() {}
};
using MakeSteppedSession = std::function<std::unique_ptr<SteppedSession>()>;

// Runs the trials of the plan. Throws Error as `make` and the files do.
ConditionResult run_stepped_condition(const ConditionPlan& plan, const ConditionEvents& events,
                                      const MakeSteppedSession& make);

}  // namespace thimble
