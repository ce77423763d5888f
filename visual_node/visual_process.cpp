#include "visual_node/visual_process.hpp"

namespace thimble {

VisualProcess::VisualProcess(std::uint64_t instance, const VisualSettings& settings, const Channels& channels,
                             Display& display, HandSource* hand)
    : NodeProcess(Role::kVisual, instance, *channels.control),
      channels_(channels),
      node_(settings),
      display_(&display),
      stale_(settings.stale),
      picture_delayed_(settings.picture_delayed),
      percept_flow_(Role::kVisual, instance, {channels.percept_out}),
      hand_flow_(instance, channels.hand_out, hand),
      go_on_(settings.subject_goes_on) {}

VisualProcess::VisualProcess(std::uint64_t instance, const VisualSettings& settings, Ports& ports,
                             Display& display, HandSource* hand)
    : VisualProcess(
          instance, settings,
          {ports.between(Port::kVisualControl, Port::kSessionVisual), ports.inlet(Port::kVisualForce),
           ports.inlet(Port::kVisualScene), ports.outlet(Port::kMasterPerceptVisual),
           hand != nullptr ? ports.outlet(Port::kMasterHand) : nullptr},
          display, hand) {
    join_stop_bus(ports);
}

void VisualProcess::begin_trial(SessionTime now, const SessionControl& control) {
    node_.start_trial(now, control, trial());
    hand_flow_.start_trial();
    display_->turn_page(now, Page{});
    go_on_.turn(now, Page{});
    force_flow_.expect_from(now + first_answer_within(control) + kPeerTimeout);  // the master starts last
    scene_flow_.expect_from(now);
}

void VisualProcess::work(SessionTime now) {
    take_force(now);
    if (running()) stale_record_.watch(now, trial(), stale_.stale(now - force_flow_.last_accepted()));
    hand_flow_.work(now, running(), trial());
    take_scene(now);
    ask_to_go_on(now);
    if (const auto scene = node_.frame(now)) display_->draw(now, *scene);
    while (const auto shown = display_->shown(now)) {
        const auto percept = node_.to_percept(*shown);
        if (percept && running()) percept_flow_.send(now, trial(), *percept);
    }
}

bool VisualProcess::read_page(SessionTime now, const Page& page) {
    if (running()) return true;  // a late one must not cover the trial
    display_->turn_page(now, page);
    if (display_->take_go_on()) go_on_.press(now);  // on the page before this one
    go_on_.turn(now, page);
    return true;
}

// Each of a tick's parts is called in one place: the compiler makes one function of them. A key of the trial's time
// is taken as well, and forgotten.
inline void VisualProcess::ask_to_go_on(SessionTime now) {
    if (display_->take_go_on()) go_on_.press(now);
    if (const auto given = display_->take_answer()) go_on_.answer(now, given->question, given->value);
    if (go_on_.take_due(now)) tell_session(now, go_on_.order());
}

inline void VisualProcess::take_force(SessionTime now) {
    force_flow_.drain<ForceFeedback>(now, *channels_.force_in, running(), trial(),
                                     [&](const Header& header, const ForceFeedback& feedback) {
                                         if (picture_delayed_)
                                             node_.on_picture(now, feedback, header.send_time);
                                         node_.on_force(now, feedback);
                                     });
}

inline void VisualProcess::take_scene(SessionTime now) {
    scene_flow_.drain_all(now, *channels_.scene_in, running(), trial(), [&](const Message& message) {
        const auto* control = std::get_if<SessionControl>(&message.body);
        if (control != nullptr && control->kind == ControlKind::kBeep) beep(now);
        const auto* feedback = std::get_if<ForceFeedback>(&message.body);
        if (feedback != nullptr && !picture_delayed_)
            node_.on_picture(now, *feedback, message.header.send_time);
        return control != nullptr || feedback != nullptr;
    });
}

void VisualProcess::beep(SessionTime now) {
    if (beeped_trial_ == trial()) return;
    beeped_trial_ = trial();
    display_->beep(now);
    percept_flow_.send(now, trial(), node_.beep(now));
}

void VisualProcess::add_counters(FlowCounters& sum) const {
    sum.add(force_flow_.counters());
    sum.add(scene_flow_.counters());
}

}  // namespace thimble
