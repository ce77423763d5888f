#include "visual_node/visual_process.hpp"

namespace thimble {

VisualProcess::VisualProcess(std::uint64_t instance, const VisualSettings& settings, const Channels& channels,
                             Display& display)
    : NodeProcess(Role::kVisual, instance, *channels.control),
      channels_(channels),
      node_(settings),
      display_(&display),
      percept_flow_(Role::kVisual, instance, {channels.percept_out}) {}

void VisualProcess::begin_trial(SessionTime now, const SessionControl& control) {
    node_.start_trial(now, control, trial());
    force_flow_.expect_from(now + first_answer_within(control) + kPeerTimeout);  // the master starts last
}

void VisualProcess::work(SessionTime now) {
    force_flow_.drain<ForceFeedback>(
        now, *channels_.force_in, running(), trial(),
        [&](const Header&, const ForceFeedback& feedback) { node_.on_feedback(now, feedback); });
    take_beep(now);
    if (const auto scene = node_.frame(now)) display_->draw(now, *scene);
    while (const auto shown = display_->shown(now)) {
        const auto percept = node_.to_percept(*shown);
        if (percept && running()) percept_flow_.send(now, trial(), *percept);
    }
}

void VisualProcess::take_beep(SessionTime now) {
    beep_flow_.drain<SessionControl>(now, *channels_.beep_in, running(), trial(),
                                     [&](const Header&, const SessionControl& control) {
                                         if (control.kind != ControlKind::kBeep || beeped_trial_ == trial())
                                             return;
                                         beeped_trial_ = trial();
                                         percept_flow_.send(now, trial(), node_.beep(now));
                                     });
}

void VisualProcess::add_counters(FlowCounters& sum) const {
    sum.add(force_flow_.counters());
    sum.add(beep_flow_.counters());
}

}  // namespace thimble
