#include <algorithm>
#include <exception>
#include <memory>

#include <fmt/format.h>

#include "netem/profiles/profiles.hpp"
#include "study/swarm/swarm.hpp"

namespace thimble {
namespace {

using std::chrono::seconds;

// After a trial: longer than any node needs to give it up by itself.
constexpr Duration kRestsAfter = std::chrono::milliseconds{1500};
// Beside what its settings allow.
constexpr Duration kTrialSlack = seconds{5};

std::shared_ptr<const LabKey> swarm_key() {
    std::array<std::uint8_t, kKeyBytes> bytes{};
    bytes.fill(27);
    return std::make_shared<const LabKey>(bytes);
}

bool flips_bits(const LinkSettings& link, const Timeline& timeline) {
    return link.corrupt > 0 || std::any_of(timeline.begin(), timeline.end(), [](const LinkChange& change) {
               return change.settings.corrupt > 0;
           });
}

// A flipped bit that leaves a message well formed may be anywhere in it.
bool flips_bits(const SwarmCase& one, const SystemSettings& s) {
    return flips_bits(s.netem.needle, s.netem.needle_timeline) ||
           flips_bits(s.netem.force, s.netem.force_timeline) ||
           std::any_of(one.faults.begin(), one.faults.end(), [](const SwarmFault& fault) {
               return fault.kind == FaultKind::kCorrupt || fault.kind == FaultKind::kProfile;
           });
}

class CaseRun {
  public:
    CaseRun(const SwarmCase& one, const SystemSettings& settings, const BreakForce& break_force)
        : case_(one),
          settings_(with_force_delay(settings, settings.plan.delays.front())),
          watch_(settings_, one.sealed || flips_bits(one, settings_)),
          plain_handle_(settings_.handle, settings_.person),
          handle_(plain_handle_, watch_, distortion(break_force)),
          actuator_(settings_.cutaneous, watch_),
          display_(settings_.visual.pipeline, watch_),
          draw_({one.seed, 0, 0, 1, Purpose::kParameter}),
          session_(settings_, one.sealed ? swarm_key() : nullptr,
                   {&handle_, &plain_handle_, nullptr, &actuator_, &display_},
                   [this](Port to, Channel& end) { return tap(to, end); }) {
        watch_.look_at(session_);
        session_.session().set_sample_hook([this](const TrajectorySample& s) { watch_.sample_recorded(s); });
    }

    void run() {
        begin_and_end_faults();
        for (std::uint32_t trial = 1; trial <= case_.trials && has_keys() && !dead(Role::kSession); ++trial) {
            run_trial(conditions_of(trial));
            run_until(now_ + kRestsAfter);
            if (!watch_.violation()) watch_.rests();
        }
        if (!watch_.violation()) watch_.count();
    }

    Watch& watch() { return watch_; }
    SessionTime now() const { return now_; }
    std::vector<EndReason>& ends() { return ends_; }

  private:
    std::function<double(double)> distortion(const BreakForce& break_force) const {
        if (!break_force) return {};
        return [this, break_force](double force_N) { return break_force(settings_, force_N); };
    }

    std::unique_ptr<Channel> tap(Port to, Channel& end) {
        return std::make_unique<WatchedWire>(end, to, watch_, active_, now_, draw_);
    }

    TrialConditions conditions_of(std::uint32_t trial) const {
        const SessionPlan& plan = settings_.plan;
        TrialConditions conditions;
        conditions.study_seed = plan.seed;
        conditions.subject = plan.subject;
        conditions.trial = trial;
        conditions.modality = plan.modalities[(trial - 1) % plan.modalities.size()];
        conditions.delay_s = to_seconds(plan.delays.front());
        conditions.fixture_position_m = settings_.slave.fixture_position_m();
        return conditions;
    }

    // Start and end wait for the nodes, and a program that stands still makes the others wait.
    Duration longest_trial() const {
        const SessionSettings& s = settings_.session;
        Duration longest = s.trial_timeout + 3 * s.peer_wait + session_settings(settings_).network_delay;
        for (const SwarmFault& fault : case_.faults) longest += fault.length;
        return longest + kTrialSlack;
    }

    void run_trial(const TrialConditions& conditions) {
        watch_.begin_trial(conditions);
        session_.start(conditions);
        const SessionTime limit = now_ + longest_trial();
        while (!session_.session().finished() && !dead(Role::kSession) && step()) {
            if (now_ <= limit) continue;
            return watch_.fail(Rule::kTrialEnds,
                               fmt::format("it runs for {} s", to_seconds(longest_trial())));
        }
        if (!session_.session().finished()) return;
        ends_.push_back(session_.session().record().reason);
        if (ends_.back() == EndReason::kNone) watch_.fail(Rule::kTrialEnds, "its record does not say why");
    }

    // A program that does not run keeps a sealed session from its start.
    bool has_keys() {
        const Security* const security = session_.network().security(Role::kSession);
        const SessionTime limit = now_ + longest_trial();
        while (security != nullptr && !security->complete() && now_ < limit && step()) {
        }
        return security == nullptr || security->complete();
    }

    void run_until(SessionTime time) {
        while (now_ < time && step()) {
        }
    }

    // One instant, and what holds after it. False once something is wrong.
    bool step() {
        if (!session_.loop().step()) return false;
        now_ = session_.now();
        watch_.instant();
        if (now_ >= next_change_) begin_and_end_faults();
        return !watch_.violation();
    }

    bool dead(Role role) const {
        return std::any_of(active_.begin(), active_.end(), [role](const SwarmFault* fault) {
            return fault->kind == FaultKind::kDeath && fault->role == role;
        });
    }
    bool frozen(Role role) const {
        return std::any_of(active_.begin(), active_.end(), [role](const SwarmFault* fault) {
            return of_program(fault->kind) && fault->role == role;
        });
    }

    static SessionTime end_of(const SwarmFault& fault) {
        return fault.kind == FaultKind::kDeath ? kNever : fault.at + fault.length;
    }

    void begin_and_end_faults() {
        next_change_ = kNever;
        for (const SwarmFault& fault : case_.faults) {
            const auto found = std::find(active_.begin(), active_.end(), &fault);
            const bool due = now_ >= fault.at && now_ < end_of(fault);
            if (due && found == active_.end()) begin(fault);
            if (!due && found != active_.end()) {
                active_.erase(found);
                end(fault);
            }
            if (now_ < fault.at) next_change_ = std::min(next_change_, fault.at);
            if (now_ < end_of(fault)) next_change_ = std::min(next_change_, end_of(fault));
        }
    }

    void begin(const SwarmFault& fault) {
        if (of_program(fault.kind) && !frozen(fault.role)) {
            session_.loop().freeze(session_.bit(fault.role));
            watch_.freeze(fault.role);
        }
        active_.push_back(&fault);
        if (of_wire(fault.kind)) watch_.disturb(fault.port);
        happen(fault);
    }

    void end(const SwarmFault& fault) {
        if (fault.kind == FaultKind::kNoNumber) handle_.no_number = false;
        if (fault.kind == FaultKind::kBroken) handle_.words.clear();
        if (!of_program(fault.kind) || frozen(fault.role)) return;
        const bool anew = fault.kind == FaultKind::kRestart;
        if (anew) restart(fault.role);
        session_.loop().thaw(session_.bit(fault.role));
        watch_.run_again(fault.role, anew);
    }

    // A device has no force when its program comes up.
    void restart(Role role) {
        if (role == Role::kMaster) handle_.command_force(now_, 0);
        if (role == Role::kCutaneous) actuator_.release(now_);
        session_.restart(role);
    }

    void happen(const SwarmFault& fault) {
        SessionProcess& session = session_.session();
        const bool steered = !frozen(Role::kSession);
        if (fault.kind == FaultKind::kStop && !frozen(fault.role))
            session_.emergency_stop(fault.role, "the swarm's stop");
        if (fault.kind == FaultKind::kRelease && steered) {
            watch_.release();
            session_.release_stop();
        }
        if (fault.kind == FaultKind::kButton) handle_.pressed = true;
        if (fault.kind == FaultKind::kBroken) handle_.words = "the swarm broke the handle";
        if (fault.kind == FaultKind::kNoNumber) handle_.no_number = true;
        if (fault.kind == FaultKind::kDelay && steered) change_delay(from_seconds(0.3 * fault.value));
        if (fault.kind == FaultKind::kProfile && steered) change_profile(fault.value);
        if (fault.kind == FaultKind::kInterrupt && steered) session.abort(EndReason::kInterrupted);
    }

    void change_delay(Duration one_way) {
        watch_.allow_delay(session_settings(settings_).network_delay + one_way + longest_profile_);
        session_.session().change_delay(one_way);
    }

    void change_profile(double share) {
        const auto& names = profile_names();
        const auto at = static_cast<std::size_t>(share * static_cast<double>(names.size()));
        const std::string_view name = names[std::min(at, names.size() - 1)];
        const LinkProfile& profile = *built_in_profile(name);
        longest_profile_ =
            std::max(longest_profile_, nearly_longest_delay(profile.up) + nearly_longest_delay(profile.down));
        watch_.allow_delay(session_settings(settings_).network_delay + longest_profile_ + seconds{1});
        if (const auto known = NetworkName::of(name)) session_.session().change_network(*known);
    }

    const SwarmCase& case_;
    SystemSettings settings_;
    Watch watch_;
    SimulatedHandle plain_handle_;
    WatchedHandle handle_;
    WatchedActuator actuator_;
    WatchedDisplay display_;
    RandomStream draw_;
    std::vector<const SwarmFault*> active_{};
    SessionTime now_{}, next_change_ = kNever;
    Duration longest_profile_{};
    std::vector<EndReason> ends_{};
    VirtualSession session_;  // last: its wires use what stands above
};

}  // namespace

SwarmOutcome run_case(SwarmCase& one, const BreakForce& break_force) {
    SwarmOutcome outcome;
    try {
        const SystemSettings settings = settings_of(one.keys);
        CaseRun run(one, settings, break_force);
        try {
            run.run();
        } catch (const std::exception& error) {
            run.watch().fail(Rule::kNoCrash, error.what());
        }
        outcome = {run.watch().violation(), run.watch().digest(), to_seconds(run.now().time_since_epoch()),
                   std::move(run.ends())};
    } catch (const std::exception& error) {
        outcome.violation = Violation{Rule::kNoCrash, {}, error.what()};
    }
    return outcome;
}

}  // namespace thimble
