#include "python/driven_session.hpp"

#include <cmath>
#include <utility>

#include "common/error.hpp"
#include "session/records/trial_table.hpp"
#include "session/settings/protocol.hpp"

namespace thimble {
namespace {

constexpr Duration kFollowPeriod = std::chrono::milliseconds{5};  // before the handle lets go by itself
constexpr double kReach_m = 10;
constexpr double kLongestDelay_s = 10;

double checked(double value, double least, double most, const char* name) {
    if (value >= least && value <= most) return value;
    throw Error(ExitCode::kUsage, "{} is {}, and must be in [{}, {}]", name, value, least, most);
}

}  // namespace

DrivenSession::DrivenSession(SystemSettings settings, Driver driver)
    : settings_(std::move(settings)), driver_(driver) {
    require_virtual_subjects(settings_, "in Python");
    settings_.session.ends_by_withdrawal = driver == Driver::kPython;
}

VirtualSession& DrivenSession::started() const {
    if (session_) return *session_;
    throw Error(ExitCode::kUsage, "no trial has begun: call start() first");
}

TrialConditions DrivenSession::conditions_of(const TrialChoice& choice) const {
    TrialConditions conditions = choice.conditions;
    if (conditions.subject == 0 || conditions.trial == 0)
        throw Error(ExitCode::kUsage, "subject {}, trial {}: both count from 1", conditions.subject,
                    conditions.trial);
    conditions.study_seed = choice.seed.value_or(settings_.plan.seed);
    const double last_s = settings_.plan.delays.empty() ? 0 : to_seconds(settings_.plan.delays.back());
    conditions.delay_s = checked(choice.delay_s.value_or(last_s), 0, kLongestDelay_s, "delay_s");
    Protocol protocol = experiment_3(settings_, 1, conditions.study_seed);
    protocol.experiment = conditions.experiment;
    conditions.fixture_position_m =
        checked(choice.fixture_m ? *choice.fixture_m
                                 : draw_fixture_position_m(protocol, conditions.subject, conditions.trial),
                -kReach_m, kReach_m, "fixture_m");
    return conditions;
}

void DrivenSession::start(const TrialChoice& choice) {
    const TrialConditions conditions = conditions_of(choice);
    session_.reset();
    pointer_ = std::make_unique<PointerHandle>(settings_.handle);
    display_ = std::make_unique<SeenDisplay>(settings_.visual);
    actuator_ = std::make_unique<SimulatedActuator>(settings_.cutaneous);
    VirtualDevices devices;
    devices.display = display_.get();
    devices.actuator = actuator_.get();
    if (driver_ == Driver::kPython) {
        devices.handle = pointer_.get();
        devices.person = pointer_.get();
    }
    session_ = std::make_unique<VirtualSession>(with_force_delay(settings_, from_seconds(conditions.delay_s)),
                                                nullptr, devices);
    input_ = {0, true};
    next_follow_ = {};
    session_->start(conditions);
}

void DrivenSession::follow() {
    if (driver_ != Driver::kPython || session_->now() < next_follow_) return;
    pointer_->follow(session_->now(), input_);
    next_follow_ = session_->now() + kFollowPeriod;
}

bool DrivenSession::step() {
    started();
    follow();
    return session_->step() && running();
}

bool DrivenSession::advance(double until_s, int instants) {
    for (started(); instants > 0; --instants) {
        if (to_seconds(session_->now().time_since_epoch()) >= until_s || !step()) return false;
    }
    return true;
}

void DrivenSession::hand(double position_m, bool engaged) {
    if (driver_ != Driver::kPython)
        throw Error(ExitCode::kUsage,
                    "the hand is the virtual operator's: Session(hand=\"python\") has one of yours");
    input_ = {checked(position_m, -kReach_m, kReach_m, "position_m"), engaged};
    next_follow_ = {};
}

void DrivenSession::change_delay(double delay_s) {
    started().session().change_delay(from_seconds(checked(delay_s, 0, kLongestDelay_s, "delay_s")));
    session_->loop().poke(session_->bit(Role::kSession));
}

void DrivenSession::stop() {
    if (!running()) return;
    session_->session().abort(EndReason::kInterrupted);
    session_->loop().poke(session_->bit(Role::kSession));
    while (step()) {
    }
}

DrivenState DrivenSession::state() {
    const SessionProcess& session = started().session();
    DrivenState state;
    state.now_s = to_seconds(session_->now().time_since_epoch());
    state.time_s = session.recorder().newest_time_s();
    state.running = running();
    state.fixture_m = record().conditions.fixture_position_m;
    if (const ForceFeedback* newest = session.recorder().newest()) {
        state.needle_m = newest->position_needle_m;
        state.surface_m = newest->position_surface_m;
        state.force_tissue_N = newest->force_tissue_N;
        state.force_fixture_N = newest->force_fixture_N;
        state.contact_s = newest->contact_time_s;
    }
    const SoftwareHandle& handle =
        driver_ == Driver::kPython ? static_cast<const SoftwareHandle&>(*pointer_) : session_->handle();
    state.handle_m = handle.position_hand_m();
    state.force_hand_N = handle.force_hand_N();
    const FingertipForce finger = actuator_->output(session_->now());
    state.force_finger_N = finger.force_N;
    if (finger.finger != Finger::kNone) state.finger = finger.finger == Finger::kIndex ? "index" : "thumb";
    state.force_bar_N = display_->newest().bar_N;
    state.beeped = display_->beeps() > 0;
    state.outcome = outcome_text(record().reason, record().lost_peer);
    return state;
}

}  // namespace thimble
