#include "browser/live_trial.hpp"

#include <algorithm>
#include <utility>

#include "session/settings/protocol.hpp"
#include "study/with_compensator.hpp"

namespace thimble {
namespace {

constexpr Duration kFollowPeriod =
    std::chrono::milliseconds{5};  // a pointer is asked more often than a screen is drawn
constexpr Duration kLongestTrial =
    std::chrono::minutes{3};  // a trial's record has a place for each millisecond
constexpr double kFrequencySpan_s = 2;

SystemSettings settings_of(const LiveChoice& choice) {
    SystemSettings settings = load_system_settings({});
    if (choice.compensator != Compensator::kNone)
        settings = with_control(settings, control_for(settings, choice.compensator));
    settings.session.trial_timeout = kLongestTrial;
    settings.session.ends_by_withdrawal = !choice.virtual_hand;
    settings.visual.fingertip = true;
    return with_force_delay(std::move(settings), from_seconds(choice.delay_s));
}

}  // namespace

LiveTrial::LiveTrial(const LiveChoice& choice)
    : choice_(choice),
      settings_(settings_of(choice)),
      pointer_(settings_.handle),
      display_(settings_.visual) {
    VirtualDevices devices;
    devices.display = &display_;
    if (!choice.virtual_hand) {
        devices.handle = &pointer_;
        devices.person = &pointer_;
    }
    session_ = std::make_unique<VirtualSession>(settings_, nullptr, devices);
    start_trial();
}

void LiveTrial::start_trial() {
    const Protocol protocol = experiment_3(settings_, 1, choice_.seed);
    TrialConditions conditions;
    conditions.study_seed = choice_.seed;
    conditions.trial = ++trials_;
    conditions.modality = choice_.modality;
    conditions.delay_s = session_->session().delay_s();
    conditions.fixture_position_m = draw_fixture_position_m(protocol, conditions.subject, conditions.trial);
    lost_at_s_.clear();
    beeps_before_ = display_.beeps();
    touching_ = false;
    session_->start(conditions);
}

void LiveTrial::poke() { session_->loop().poke(session_->bit(Role::kSession)); }

void LiveTrial::change_delay(double delay_s) {
    session_->session().change_delay(from_seconds(delay_s));
    poke();
}

bool LiveTrial::change_network(std::string_view name) {
    const auto known = NetworkName::of(name);
    if (!known || !session_->session().change_network(*known)) return false;
    poke();
    return true;
}

void LiveTrial::advance(double seconds) {
    const SessionTime start = std::max(end_, session_->now());
    end_ = start + from_seconds(seconds);
    SessionTime next_look = start;
    while (session_->now() < end_) {
        if (!choice_.virtual_hand && session_->now() >= next_look) {
            pointer_.follow(session_->now(), hand_);
            next_look = session_->now() + kFollowPeriod;
        }
        if (!session_->step()) start_trial();
        watch_contact();
    }
}

void LiveTrial::watch_contact() {
    const ForceFeedback* newest = session_->session().recorder().newest();
    if (newest == nullptr) return;
    const bool touches = newest->contact_time_s > 0;
    if (touching_ && !touches) lost_at_s_.push_back(session_->session().recorder().newest_time_s());
    touching_ = touches;
}

LiveState LiveTrial::state() const {
    const SessionProcess& session = session_->session();
    LiveState state;
    state.time_s = session.recorder().newest_time_s();
    state.fixture_m = session.record().conditions.fixture_position_m;
    if (const ForceFeedback* newest = session.recorder().newest()) {
        state.needle_m = newest->position_needle_m;
        state.surface_m = newest->position_surface_m;
        state.force_total_N = newest->force_total_N;
        state.hold_s = newest->contact_time_s;
    }
    state.hand_m = settings_.master.position_scale * hand_.position_hand_m;
    state.force_hand_N = choice_.virtual_hand ? session_->handle().force_hand_N() : pointer_.force_hand_N();
    state.force_finger_N = display_.newest().fingertip_N;
    state.force_bar_N = display_.newest().bar_N;
    state.energy_in_J = session_->master().energy().energy_in_J();
    state.contacts_lost = static_cast<double>(lost_at_s_.size());
    state.frequency_Hz =
        static_cast<double>(std::count_if(lost_at_s_.begin(), lost_at_s_.end(),
                                          [&](double at) { return at > state.time_s - kFrequencySpan_s; })) /
        kFrequencySpan_s;
    state.beeps = static_cast<double>(display_.beeps() - beeps_before_);
    state.trials = trials_ - 1;
    state.delay_s = session.delay_s();
    return state;
}

Scene LiveTrial::scene() const {
    Scene scene = display_.newest();
    const ForceFeedback* newest = session_->session().recorder().newest();
    if (newest == nullptr) return scene;
    // Until the first frame nothing has said where the skin rests.
    if (scene.trial == 0) scene.position_surface_rest_m = newest->position_surface_m;
    CutAway cut;
    cut.position_needle_m = newest->position_needle_m;
    cut.position_fixture_m = session_->session().record().conditions.fixture_position_m;
    cut.force_tissue_N = newest->force_tissue_N;
    cut.force_fixture_N = newest->force_fixture_N;
    cut.phase = newest->phase;
    cut.modality = choice_.modality;
    cut.fixture_present = newest->fixture_present;
    if (hand_.engaged) cut.position_hand_m = settings_.master.position_scale * hand_.position_hand_m;
    scene.position_needle_m = newest->position_needle_m;
    scene.position_surface_m = newest->position_surface_m;
    scene.cut_away = cut;
    return scene;
}

}  // namespace thimble
