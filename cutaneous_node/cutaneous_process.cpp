#include "cutaneous_node/cutaneous_process.hpp"

namespace thimble {

CutaneousProcess::CutaneousProcess(std::uint64_t instance, const CutaneousSettings& settings, Ports& ports,
                                   FingertipActuator& actuator)
    : NodeProcess(Role::kCutaneous, instance,
                  *ports.between(Port::kCutaneousControl, Port::kSessionCutaneous)),
      force_in_(ports.inlet(Port::kCutaneousForce)),
      percept_flow_(Role::kCutaneous, instance, {ports.outlet(Port::kMasterPerceptCutaneous)}),
      actuator_(settings.guard_limit_N, actuator),
      node_(settings, actuator_) {
    join_stop_bus(ports);
}

void CutaneousProcess::begin_trial(SessionTime now, const SessionControl& control) {
    force_flow_.expect_from(now + first_answer_within(control) + kPeerTimeout);  // the master starts last
    actuator_.clear(now);
    node_.start_trial(now, control, force_flow_.last_accepted());
}

void CutaneousProcess::work(SessionTime now) {
    node_.begin_tick(now, since_last_tick(), resting());
    force_flow_.drain<ForceFeedback>(now, *force_in_, running(), trial(),
                                     [&](const Header& header, const ForceFeedback& feedback) {
                                         node_.on_feedback(now, header.send_time, feedback);
                                     });
    if (running() && node_.presses()) stale_record_.watch(now, trial(), node_.stale(now));
    actuator_.tick(now);
    if (const auto percept = node_.percept(now)) percept_flow_.send(now, trial(), *percept);
}

}  // namespace thimble
