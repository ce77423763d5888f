#include "cutaneous_node/cutaneous_process.hpp"

namespace thimble {

CutaneousProcess::CutaneousProcess(std::uint64_t instance, const CutaneousSettings& settings,
                                   const Channels& channels, FingertipActuator& actuator)
    : NodeProcess(Role::kCutaneous, instance, *channels.control),
      channels_(channels),
      actuator_(settings.guard_limit_N, actuator),
      node_(settings, actuator_),
      stale_after_(settings.stale.after),
      percept_flow_(Role::kCutaneous, instance, {channels.percept_out}) {}

CutaneousProcess::CutaneousProcess(std::uint64_t instance, const CutaneousSettings& settings, Ports& ports,
                                   FingertipActuator& actuator)
    : CutaneousProcess(instance, settings,
                       {ports.between(Port::kCutaneousControl, Port::kSessionCutaneous),
                        ports.inlet(Port::kCutaneousForce), ports.outlet(Port::kMasterPerceptCutaneous)},
                       actuator) {
    join_stop_bus(ports);
}

void CutaneousProcess::begin_trial(SessionTime now, const SessionControl& control) {
    needed_ = node_.presses(control.modality);
    actuator_.clear();
    node_.start_trial(now, control);
    force_flow_.expect_from(now + first_answer_within(control) + kPeerTimeout);  // the master starts last
    age_.begin(now, first_answer_within(control));
    fresh_ = force_flow_.last_accepted();
}

// Late forces, and those that waited while this program stood still, count as if they had not come. The node lets go, and not
// the actuator alone: it would go on from the last force otherwise.
void CutaneousProcess::work(SessionTime now) {
    const bool stood_still = since_last_tick() > stale_after_;
    force_flow_.drain<ForceFeedback>(now, *channels_.force_in, running(), trial(),
                                     [&](const Header& header, const ForceFeedback& feedback) {
                                         age_.take_from_elsewhere(now, header.send_time);
                                         if (stood_still || age_.late(now) >= stale_after_) return;
                                         fresh_ = now;
                                         if (!resting()) node_.on_feedback(now, feedback);
                                     });
    if ((running() && stood_still) || resting()) node_.let_go(now);
    if (running() && needed_) stale_record_.watch(now, trial(), stood_still || now - fresh_ > stale_after_);
    actuator_.tick(now);
    if (const auto percept = node_.percept(now)) percept_flow_.send(now, trial(), *percept);
}

}  // namespace thimble
