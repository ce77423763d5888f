#include "visual_node/views/monitor_receiver.hpp"

namespace thimble {

Duration MonitorReceiver::age(SessionTime now) const { return heard_ ? now - arrived_ : Duration::max(); }

const ReplayState* MonitorReceiver::replay() const {
    const bool said = replay_arrived_ != kNever && arrived_ - replay_arrived_ <= kReplaySilence;
    return said ? &replay_ : nullptr;
}

void MonitorReceiver::keep(SessionTime now, const Header& header, const Monitor& monitor) {
    heard_ = true;
    arrived_ = now;
    trial_ = header.trial;
    monitor_ = monitor;
    if (monitor.reason != EndReason::kDeviceFault) fault_ = {};
}

}  // namespace thimble
